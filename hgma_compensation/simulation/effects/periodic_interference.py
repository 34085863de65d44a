"""A line that is not in the temperature: a compressor, an alias of the mains."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class PeriodicInterference(Effect):
    """amplitude: m/s². period: s. phase: rad at the beginning."""

    amplitude: float
    period: float
    phase: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return A·sin(2πt/P + φ) (n,)."""
        return np.asarray(self.amplitude * np.sin(2.0 * np.pi * around.time / self.period + self.phase))
