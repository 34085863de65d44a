"""A memory of the temperature that hears of nothing outside the calibrated range."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.effects.memory import TemperatureMemory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LimitedMemory:
    """A memory that is told temperatures inside the limits (°C) only; with None, one that remembers nothing."""

    memory: TemperatureMemory | None
    limits: tuple[float, float]

    @property
    def size(self) -> int:
        """Return the size m of the state."""
        return 0 if self.memory is None else self.memory.size

    def start(self, temperature: float) -> Array:
        """Return the state (m,) of a sensor that has been at a temperature (°C) for ever."""
        return np.empty(0) if self.memory is None else self.memory.start(self._inside(np.array([temperature])))

    def advance(self, state: Array, seconds: Array, before: Array, temperature: Array) -> Array:
        """Return states (n, m) some seconds (n,) after ``state`` (n, m), the temperature going from before to now."""
        if self.memory is None:
            return state
        return self.memory.advance(
            state, seconds[:, None], self._inside(before)[:, None], self._inside(temperature)[:, None]
        )

    def _inside(self, temperature: Array) -> Array:
        return np.minimum(np.maximum(temperature, self.limits[0]), self.limits[1])
