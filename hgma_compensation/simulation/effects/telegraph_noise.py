"""A bias that jumps between two levels at random times (burst noise)."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class TelegraphNoise(Effect):
    """amplitude: m/s² between the levels. mean_low, mean_high: s, mean stays in them."""

    amplitude: float
    mean_low: float
    mean_high: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return 0 or the amplitude (n,), stays exponentially distributed, beginning low."""
        length = around.time[-1] - around.time[0]
        # Twice the expected number of pairs and some: short of the end with a probability below 1e-9.
        pairs = int(2.0 * length / (self.mean_low + self.mean_high)) + 60
        stays = random.exponential([self.mean_low, self.mean_high], (pairs, 2)).ravel()
        passed = np.searchsorted(around.time[0] + np.cumsum(stays), around.time, side="right")
        return np.asarray(self.amplitude * (passed % 2), dtype=np.float64)
