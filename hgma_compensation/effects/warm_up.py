"""Warm-up: what the sensor's own heat and its electronics do after power comes on."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import sqrt
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import SETTLED, Array, Effect, Span, Survey
from hgma_compensation.effects.memory import Coldness
from hgma_compensation.effects.registry import register


@register
@dataclass(frozen=True)
class WarmUp(Effect):
    """A·e^(−t/τ), t since power-on after a long rest; less after a short one, in which the sensor cooled in part.

    With a ``spread`` there are two time constants, τ/√spread and τ·√spread.
    """

    time_constant: float
    spread: float = 1.0

    name = "warm_up"
    title = "warm-up after power-on"
    slow = True
    spans: ClassVar[dict[str, Span]] = {
        "time_constant": Span("s", 5.0, 14400.0),
        "spread": Span("", 1.0, 10.0, searched=False),
    }
    identified_by = "three power-ons or more, at different temperatures"
    confused_with = ("aging", "post_shock_zero_shift")
    folds_in_time = True

    @property
    def time_constants(self) -> tuple[float, ...]:
        """Time constants of the columns, s."""
        if self.spread == 1.0:
            return (self.time_constant,)
        return (self.time_constant / sqrt(self.spread), self.time_constant * sqrt(self.spread))

    @property
    def settling(self) -> float:
        """Three of the longer time constant: a node cannot know how long its sensor has been on."""
        return SETTLED * max(self.time_constants)

    @property
    def count(self) -> int:
        """One column for each time constant."""
        return len(self.time_constants)

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the exponentials, 1 at power-on after a long rest."""
        return state

    def memory(self) -> Coldness:
        """Return how cold the sensor is."""
        return Coldness(self.time_constants)

    def richer(self, survey: Survey) -> Iterator["WarmUp"]:
        """Yield the form of two time constants."""
        if self.spread == 1.0:
            yield replace(self, spread=3.0)

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["WarmUp"]:
        """Yield time constants from what the data resolve to the duration."""
        shortest = min(max(5.0, survey.interval), 60.0)
        longest = min(max(survey.duration, 120.0), 14400.0)
        for time_constant in np.geomspace(shortest, longest, 12):
            yield cls(float(time_constant))
