"""An effect with its gains on a channel: what a calibration lists."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect


@dataclass(frozen=True)
class AppliedEffect:
    """channel: of CHANNELS. gains: (k,) in the channel's unit over that of each column of the effect."""

    channel: str
    effect: Effect
    gains: Array

    def is_same(self, other: "AppliedEffect") -> bool:
        """Return whether the other is the same effect on the same channel, whatever its gains."""
        return self.channel == other.channel and self.effect == other.effect

    def drift(self, at: Conditions, state: Array) -> Array:
        """Return what the effect adds to the channel (n,); added up column by column, so that no row changes another.

        state: (n, m) of the effect's memory.
        """
        columns = self.effect.columns(at, state)
        total = np.zeros(len(at))
        for column, gain in zip(columns.T, self.gains.tolist(), strict=True):
            total += gain * column
        return total
