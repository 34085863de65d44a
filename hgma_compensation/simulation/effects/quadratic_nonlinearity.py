"""A response that is even in the acceleration."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class QuadraticNonlinearity(Effect):
    """fraction: relative error of a reading at ±level (m/s²), of the same sign on both sides."""

    fraction: float
    level: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return fraction·u²/level (n,), u the true acceleration."""
        return np.asarray(self.fraction * around.acceleration[:, around.column] ** 2 / self.level)
