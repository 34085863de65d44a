"""What an effect is given and what it returns."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Events:
    """Shocks along one axis: times (k,) in s of their ends, signed peaks (k,) in m/s²."""

    times: Array
    peaks: Array


@dataclass(frozen=True)
class Surroundings:
    """All that an effect on one axis can answer to.

    At the accelerometer's times, each (n,): time in s, evenly spaced by ``step``; temperature of the sensor (°C) and
    its rate (°C/s); temperature_2 of the package (°C); voltage_deviation from nominal (V); powered; the
    vibration_power of the axis ((m/s²)²); acceleration (n, 3) in m/s², the axis' own in ``column``.
    On the grid of the oven, each (m,): grid (s) and grid_temperature (°C). static: drift of the axis at temperatures.
    """

    step: float
    time: Array
    temperature: Array
    rate: Array
    temperature_2: Array
    voltage_deviation: Array
    powered: NDArray[np.bool_]
    vibration_power: Array
    acceleration: Array
    column: int
    shocks: Events
    grid: Array
    grid_temperature: Array
    static: Callable[[Array], Array]

    def at_samples(self, on_grid: Array) -> Array:
        """Return values (m,) of the oven's grid at the accelerometer's times."""
        return np.interp(self.time, self.grid, on_grid)


class Effect(ABC):
    """A disturbance of one axis."""

    needs: str | None = None
    """Part of the scenario without which the effect could do nothing."""

    @abstractmethod
    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return what the effect adds to the axis (n,), m/s²."""
