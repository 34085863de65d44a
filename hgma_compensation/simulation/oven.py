"""Temperatures in the oven: set-point, chamber, sensor, and when the sensor is powered."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.simulation.description import Oven, Powered
from hgma_compensation.simulation.filters import low_pass

Array = NDArray[np.float64]

GRID = 0.1
"""Step of the temperature's simulation, s: far below any time constant of an oven."""


@dataclass(frozen=True)
class Temperatures:
    """time: s, chamber and sensor: °C, each (m,) in steps of GRID."""

    time: Array
    chamber: Array
    sensor: Array


def temperatures(oven: Oven) -> Temperatures:
    """Return what chamber and sensor make of the set-point, two first-order lags one after the other."""
    grid = np.arange(0.0, oven.duration + GRID, GRID)
    chamber = low_pass(set_point(oven, grid), oven.chamber_time_constant, GRID)
    if oven.ripple is not None:
        chamber = chamber + oven.ripple.amplitude * np.sin(2.0 * np.pi * grid / oven.ripple.period)
    return Temperatures(grid, chamber, low_pass(chamber, oven.time_constant, GRID))


def set_point(oven: Oven, time: Array) -> Array:
    """Return the set-point (n,) in °C at times (n,) in s."""
    corners, before, now = [(0.0, oven.start)], oven.start, 0.0
    for step in oven.program:
        now += 60.0 * abs(step.to - before) / step.rate
        corners.append((now, step.to))
        now += 60.0 * step.soak
        corners.append((now, step.to))
        before = step.to
    return np.interp(time, *np.array(corners).T)


def power_state(powered: tuple[Powered, ...], time: Array) -> NDArray[np.bool_]:
    """Return whether the sensor is on at times (n,)."""
    on = np.zeros(len(time), dtype=bool)
    for interval in powered:
        on |= (time >= interval.start) & (time < interval.end)
    return on
