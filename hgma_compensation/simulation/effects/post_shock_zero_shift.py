"""A zero that a shock along the axis moves."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class PostShockZeroShift(Effect):
    """permanent, transient: share of the shock's signed peak that stays, and that decays.

    time_constant: s of the decay. threshold: m/s² of peak below which nothing happens.
    """

    permanent: float
    transient: float
    time_constant: float
    threshold: float = 0.0

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return Σ H(t − ts)·peak·(s + q·e^(−(t − ts)/τ)) (n,)."""
        total = np.zeros(len(around.time))
        for end, peak in zip(around.shocks.times, around.shocks.peaks, strict=True):
            after = around.time >= end
            if abs(peak) >= self.threshold:
                decay = np.exp(-(around.time[after] - end) / self.time_constant)
                total[after] += peak * (self.permanent + self.transient * decay)
        return total
