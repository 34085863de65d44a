"""Accelerometer stamps that run ahead of the thermometer's."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class TimingOffset(Effect):
    """delay: s by which the acceleration belongs to an earlier temperature; negative: to a later one."""

    delay: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return f(T(t − delay)) − f(T(t)) (n,), f the static drift."""
        delayed = np.interp(around.time - self.delay, around.grid, around.grid_temperature)
        return around.static(delayed) - around.static(around.temperature)
