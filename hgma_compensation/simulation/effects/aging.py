"""Drift with time alone."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class Aging(Effect):
    """rate: m/s² per hour, at the beginning where logarithmic_after (s) is given, throughout where it is 0."""

    rate: float
    logarithmic_after: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return k·t, or k·t0·ln(1 + t/t0) (n,)."""
        per_second, t0 = self.rate / 3600.0, self.logarithmic_after
        return per_second * (t0 * np.log1p(around.time / t0) if t0 > 0.0 else around.time)
