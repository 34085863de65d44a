"""Hysteresis whose loop widens with a power of the rate."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Span, Survey
from hgma_compensation.effects.registry import register

_REFERENCE = 1.0 / 60.0
"""Rate at which the column is 1: 1 °C/min, in °C/s."""


@register
@dataclass(frozen=True)
class RateDependentHysteresis(Effect):
    """sgn(Ṫ)·abs(Ṫ)^p, smooth below the rate_floor: Ṫ·(Ṫ² + floor²)^((p−1)/2) (EFFECTS catalogue form).

    Scaled to be 1 at 1 °C/min. Without a floor the noise of a steady thermistor would be blown up by p < 1.
    """

    exponent: float
    rate_floor: float

    name = "rate_dependent_hysteresis"
    title = "hysteresis in temperature that grows with the rate"
    slow = True
    spans: ClassVar[dict[str, Span]] = {
        "exponent": Span("", 0.1, 2.0),
        "rate_floor": Span("°C/s", 1e-6, 1.0, searched=False),
    }
    identified_by = "ramps at three rates or more, in both directions"
    confused_with = ("hysteresis", "thermal_lag")
    family = "hysteresis"

    @property
    def count(self) -> int:
        """One column."""
        return 1

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the power of the rate."""
        rate, floor = at.rate / _REFERENCE, self.rate_floor / _REFERENCE
        power = ((rate * rate + floor * floor) / (1.0 + floor * floor)) ** (0.5 * (self.exponent - 1.0))
        return np.asarray((rate * power)[:, None])

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["RateDependentHysteresis"]:
        """Yield exponents to both sides of 1, which would be a lag."""
        floor = min(max(0.02 * survey.ramp, 1e-6), 1.0)
        for exponent in (0.25, 0.375, 0.5, 0.625, 0.75, 1.5, 2.0):
            yield cls(exponent, floor)
