"""Creep of glue and solder: stress that a change of temperature makes and time takes away."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import SETTLED, Array, Effect, Span, Survey
from hgma_compensation.effects.memory import LowPass
from hgma_compensation.effects.registry import register


@register
@dataclass(frozen=True)
class StressRelaxation(Effect):
    """Σ gᵢ·(T − LPτᵢ T), one pole, or τ with τ/spread and spread·τ beside it (Prony series; Ferry 1980, ch. 3)."""

    time_constant: float
    spread: float = 1.0

    name = "stress_relaxation"
    title = "stress relaxation (creep) of die attach or solder"
    slow = True
    spans: ClassVar[dict[str, Span]] = {
        "time_constant": Span("s", 500.0, 2e5),
        "spread": Span("", 1.0, 10.0, searched=False),
    }
    identified_by = "soaks of one to two time constants after ramps in both directions, and a minor loop"
    confused_with = ("hysteresis", "thermal_lag", "aging")
    gain_unit = "/°C"

    def memory(self) -> LowPass:
        """Return the poles."""
        if self.spread == 1.0:
            return LowPass((self.time_constant,))
        return LowPass((self.time_constant / self.spread, self.time_constant, self.time_constant * self.spread))

    @property
    def settling(self) -> float:
        """Three of the slowest pole's time constants."""
        return SETTLED * max(self.memory().time_constants)

    @property
    def count(self) -> int:
        """One column for each pole."""
        return self.memory().size

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return T − LPτᵢ T, °C."""
        return at.temperature[:, None] - state

    def richer(self, survey: Survey) -> Iterator["StressRelaxation"]:
        """Yield the series of three poles."""
        if self.spread == 1.0:
            yield StressRelaxation(self.time_constant, 3.0)

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["StressRelaxation"]:
        """Yield time constants from those of a lag to twice the recording."""
        longest = min(max(2000.0, 2.0 * survey.duration), 2e5)
        for time_constant in np.geomspace(700.0, longest, 12):
            yield cls(float(time_constant), 1.0)
