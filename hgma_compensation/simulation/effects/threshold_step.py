"""A step at a temperature, the same on every pass."""

from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class ThresholdStep(Effect):
    """temperature: °C of its middle. height: m/s². width: °C between 10 and 90 % of it."""

    temperature: float
    height: float
    width: float = 0.4

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return height / (1 + e^(−(T − Tc)/s)) (n,), s = width / (2 ln 9)."""
        return np.asarray(self.height * expit((around.temperature - self.temperature) * 2.0 * np.log(9.0) / self.width))
