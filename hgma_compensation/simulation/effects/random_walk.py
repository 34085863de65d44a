"""A zero that wanders without end (rate random walk of IEEE Std 952)."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class RandomWalk(Effect):
    """coefficient: K, m/s²/√s; the Allan deviation is K·√(τ/3)."""

    coefficient: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return the sum of independent steps of deviation K·√dt (n,), zero at first."""
        steps = self.coefficient * np.sqrt(around.step) * random.standard_normal(len(around.time))
        return np.cumsum(steps) - steps[0]
