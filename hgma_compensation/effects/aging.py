"""Aging: drift with time alone, straight or slowing down."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Span, Survey
from hgma_compensation.effects.registry import register
from hgma_compensation.stamps import seconds_between


@register
@dataclass(frozen=True)
class Aging(Effect):
    """k·t0·ln(1 + t/t0) (EFFECTS catalogue form): k·t up to the onset t0, then slower; at 1e9 s a straight line.

    t: s since ``origin``, held after ``limit`` seconds, beyond which a fitted trend is a guess.
    """

    onset: float
    origin: float
    limit: float

    name = "aging"
    title = "aging: drift with time"
    slow = True
    spans: ClassVar[dict[str, Span]] = {
        "onset": Span("s", 10.0, 1e9),
        "origin": Span("ns", 0.0, 9.2e18, searched=False),
        "limit": Span("s", 1.0, 1e10, searched=False),
    }
    identified_by = "the same temperature visited again and again, over hours"
    confused_with = ("warm_up", "post_shock_zero_shift", "stress_relaxation")
    gain_unit = "/h"
    folds_in_time = True

    @property
    def count(self) -> int:
        """One column."""
        return 1

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the age, h."""
        elapsed = np.clip(seconds_between(at.stamps, int(self.origin)), 0.0, self.limit)
        return np.asarray((self.onset * np.log1p(elapsed / self.onset) / 3600.0)[:, None])

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["Aging"]:
        """Yield onsets from minutes to never."""
        limit = min(max(3.0 * survey.duration, 3.0 * survey.lifetime, 1.0), 1e10)
        for onset in (100.0, 300.0, 1e3, 3e3, 1e4, 1e9):
            yield cls(onset, float(survey.origin), limit)
