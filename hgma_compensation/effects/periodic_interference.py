"""Periodic interference: an oven's compressor, an alias of the mains."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Span, Survey
from hgma_compensation.effects.registry import register
from hgma_compensation.effects.requirements import require_whole
from hgma_compensation.stamps import seconds_between


@register
@dataclass(frozen=True)
class PeriodicInterference(Effect):
    """Σ aₘ·sin(2πmt/P) + bₘ·cos(2πmt/P), P the period, m up to ``harmonics`` (a Fourier series).

    t: s since ``origin``, or, with from_power_on = 1, since the sensor was switched on.
    """

    period: float
    origin: float
    harmonics: float = 1.0
    from_power_on: float = 0.0

    name = "periodic_interference"
    title = "periodic interference"
    spans: ClassVar[dict[str, Span]] = {
        "period": Span("s", 2.0, 2e4),
        "origin": Span("ns", 0.0, 9.2e18, searched=False),
        "harmonics": Span("", 1.0, 4.0, searched=False),
        "from_power_on": Span("", 0.0, 1.0, searched=False),
    }
    identified_by = "twenty periods or more"
    folds_in_time = True

    @property
    def count(self) -> int:
        """Sine and cosine of each harmonic."""
        return 2 * int(self.harmonics)

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the sines and the cosines."""
        since = at.since_power_on if self.from_power_on else seconds_between(at.stamps, int(self.origin))
        cycles = since / self.period
        phase = 2.0 * np.pi * (cycles - np.floor(cycles))
        waves = [wave(m * phase) for m in range(1, int(self.harmonics) + 1) for wave in (np.sin, np.cos)]
        return np.column_stack(waves)

    def check(self) -> None:
        """Refuse parameters outside their spans, and a part of a harmonic."""
        super().check()
        require_whole("harmonics", self.harmonics)
        require_whole("from_power_on", self.from_power_on)

    def richer(self, survey: Survey) -> Iterator["PeriodicInterference"]:
        """Yield forms that are no pure sine."""
        for harmonics in (2.0, 4.0):
            if harmonics > self.harmonics:
                yield replace(self, harmonics=harmonics)

    def search_step(self, survey: Survey) -> float:
        """Return the change of ln P that moves the phase at the end of the data by a fraction of a turn."""
        whole = survey.duration if self.from_power_on else max(survey.lifetime, survey.duration)
        return 0.3 * self.period / max(whole, self.period)

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["PeriodicInterference"]:
        """Yield nothing: a diagnosis reads periods off the spectrum of what is left."""
        yield from ()
