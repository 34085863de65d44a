"""Zero shift: what a shock leaves behind, for good or for a while."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.acceleration_memory import ShockSums
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import SETTLED, Array, Effect, Span, Survey
from hgma_compensation.effects.registry import register
from hgma_compensation.effects.requirements import require_channel

_THRESHOLD = Span("m/s^2", 1e-6, 1e7, searched=False)


@register
@dataclass(frozen=True)
class PostShockZeroShift(Effect):
    """Σ H(t − tₛ)·pₛ·(s + q·e^(−(t−tₛ)/τ)) over shocks at tₛ with signed peaks pₛ (EFFECTS catalogue form)."""

    threshold: float
    time_constant: float
    channel: str

    name = "post_shock_zero_shift"
    title = "zero shift after shocks"
    spans: ClassVar[dict[str, Span]] = {"threshold": _THRESHOLD, "time_constant": Span("s", 1.0, 1e5)}
    identified_by = "three shocks or more, with quiet stretches after them"
    confused_with = ("aging", "warm_up")
    gain_unit = "/(m/s^2)"
    per_sample = True
    folds_in_time = True

    def check(self) -> None:
        """Refuse parameters outside their spans, and what is not a channel."""
        super().check()
        require_channel("channel", self.channel)

    def acceleration_memory(self) -> ShockSums:
        """Return the sums over the shocks."""
        return ShockSums(self.threshold, self.time_constant)

    @property
    def settling(self) -> float:
        """Three time constants of the decaying part; what earlier shocks left for good stays unknown."""
        return SETTLED * self.time_constant

    @property
    def count(self) -> int:
        """A permanent and a decaying column."""
        return 2

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the sum of the peaks and the decaying sum, m/s²."""
        return state[:, :2]

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["PostShockZeroShift"]:
        """Yield time constants up to the duration for shocks of 20 times the noise; nothing where that is none."""
        threshold = 20.0 * survey.noise
        if survey.shocks and _THRESHOLD.lower <= threshold <= _THRESHOLD.upper:
            shortest = min(max(1.0, survey.interval), 100.0)
            for time_constant in np.geomspace(shortest, min(max(survey.duration, 1000.0), 1e5), 10):
                yield cls(threshold, float(time_constant), survey.channel)
