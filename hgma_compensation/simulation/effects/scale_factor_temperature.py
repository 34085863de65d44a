"""A scale factor that changes with temperature."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.drift import normalised
from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class ScaleFactorTemperature(Effect):
    """linear, quadratic: relative change of the scale factor over 35 °C."""

    linear: float
    quadratic: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return u·(a·x + b·x²) (n,), u the true acceleration, x = (T − 25)/35."""
        x = normalised(around.temperature)
        return around.acceleration[:, around.column] * (self.linear * x + self.quadratic * x**2)
