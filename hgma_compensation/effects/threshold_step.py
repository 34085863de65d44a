"""A step at one temperature: a mode change of the readout, a contact, a phase transition of an adhesive."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Span, Survey
from hgma_compensation.effects.registry import register


@register
@dataclass(frozen=True)
class ThresholdStep(Effect):
    """1/(1 + e^(−4(T − Tc)/width)), a step about Tc = temperature (EFFECTS catalogue form)."""

    temperature: float
    width: float = 0.4

    name = "threshold_step"
    title = "step at a temperature"
    slow = True
    spans: ClassVar[dict[str, Span]] = {
        "temperature": Span("°C", -100.0, 250.0),
        "width": Span("°C", 0.01, 20.0, searched=False),
    }
    identified_by = "the temperature of the step crossed four times or more, both ways"

    @property
    def count(self) -> int:
        """One column."""
        return 1

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the step, 0...1."""
        # The logistic function written as a hyperbolic tangent, which cannot overflow.
        return np.asarray((0.5 + 0.5 * np.tanh((at.temperature - self.temperature) * (2.0 / self.width)))[:, None])

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["ThresholdStep"]:
        """Yield temperatures 1 °C apart or less, 1 °C inside of what was visited."""
        low, high = survey.lowest + 1.0, survey.highest - 1.0
        if high >= low:
            for temperature in np.linspace(low, high, ceil(high - low) + 1):
                yield cls(float(temperature))
