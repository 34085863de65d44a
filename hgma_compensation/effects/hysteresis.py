"""Hysteresis that does not depend on the rate: dry friction and plastic strain in the package."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Span, Survey, normalised
from hgma_compensation.effects.memory import Play
from hgma_compensation.effects.registry import register
from hgma_compensation.effects.requirements import geometric, require_whole

NO_PAST = -273.15

WIDEST = 0.4
"""Threshold of the widest play over the span of temperatures: it then turns in a sweep over all of it."""

SPREAD, PLAYS = 1.8, 7.0
"""Of the form with several plays."""


@register
@dataclass(frozen=True)
class Hysteresis(Effect):
    """Σ kᵣ·(playᵣ − T) (Prandtl–Ishlinskii; Visintin 1994, section III.2), x = (T − 25 °C)/35 °C.

    One play of ``threshold``, or several with it in their middle, each ``spread`` times as wide as the one before.
    bend = 1: each column times x too. The material remembers: before, offset: at ``before`` °C the plays stood
    ``offset`` thresholds above the temperature (+1 after cooling, -1 after heating), and from there it went straight
    to the first temperature; NO_PAST °C for a material without a past.
    """

    threshold: float
    spread: float = 1.0
    bend: float = 0.0
    plays: float = 1.0
    before: float = NO_PAST
    offset: float = 0.0

    name = "hysteresis"
    title = "hysteresis in temperature, independent of the rate"
    slow = True
    spans: ClassVar[dict[str, Span]] = {
        "threshold": Span("°C", 0.02, 60.0),
        "spread": Span("", 1.0, 10.0, searched=False),
        "bend": Span("", 0.0, 1.0, searched=False),
        "plays": Span("", 1.0, 8.0, searched=False),
        "before": Span("°C", NO_PAST, 250.0, searched=False),
        "offset": Span("", -1.0, 1.0, searched=False),
    }
    identified_by = "minor loops, return points and several rates"
    confused_with = ("stress_relaxation", "rate_dependent_hysteresis")
    gain_unit = "/°C"

    def check(self) -> None:
        """Refuse parameters outside their spans, and parts of a bend or a play."""
        super().check()
        require_whole("bend", self.bend)
        require_whole("plays", self.plays)

    def memory(self) -> Play:
        """Return the plays."""
        before = None if self.before == NO_PAST else self.before
        return Play(geometric(self.threshold, self.spread, self.plays), before, self.offset)

    @property
    def settling_span(self) -> float:
        """Twice the widest threshold: over such a span every play is dragged along, wherever it stood."""
        return 2.0 * max(self.memory().thresholds)

    @property
    def count(self) -> int:
        """One column for each play, two where they bend."""
        return self.memory().size * (1 + int(self.bend))

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return playᵣ − T, °C, then the same times x."""
        plays = state - at.temperature[:, None]
        if not self.bend:
            return plays
        return np.hstack([plays, plays * normalised(at.temperature)[:, None]])

    def richer(self, survey: Survey) -> Iterator["Hysteresis"]:
        """Yield the form of seven plays, that whose loop changes its width with the temperature, and both."""
        if not self.bend:
            yield replace(self, bend=1.0)
        if self.plays == 1.0:
            several = replace(self, spread=SPREAD, plays=PLAYS)
            several = replace(several, threshold=min(self.threshold, several.widest_middle(survey)))
            yield several
            yield replace(several, bend=1.0)

    def widest_middle(self, survey: Survey) -> float:
        """Return the threshold, °C, with which the widest play still turns within the survey's temperatures."""
        widest = WIDEST * (survey.highest - survey.lowest)
        return float(max(widest / self.spread ** (0.5 * (self.plays - 1.0)), self.spans["threshold"].lower))

    def inside(self, survey: Survey) -> bool:
        """Return whether every play turns: one that does not is an offset of each recording, not of the next one."""
        return self.threshold <= self.widest_middle(survey) * (1.0 + 1e-9)

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["Hysteresis"]:
        """Yield thresholds up to 0.4 of the span; none where the temperature hardly moves."""
        widest = min(WIDEST * (survey.highest - survey.lowest), 60.0)
        if widest > 0.1:
            for threshold in np.geomspace(0.1, widest, 12):
                yield cls(float(threshold))
