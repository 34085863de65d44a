"""The sensing element follows its thermometer late."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings
from hgma_compensation.simulation.filters import low_pass
from hgma_compensation.simulation.oven import GRID


@dataclass(frozen=True)
class ThermalLag(Effect):
    """Two lags in cascade: time_constant and second_time_constant, s (0: none)."""

    time_constant: float
    second_time_constant: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return f(LPτ₂ LPτ₁ T) − f(T) (n,), f the static drift."""
        lagged = low_pass(low_pass(around.grid_temperature, self.time_constant, GRID), self.second_time_constant, GRID)
        return around.static(around.at_samples(lagged)) - around.static(around.temperature)
