"""Vibration rectification: vibration that the transducer turns into a steady output."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.acceleration_memory import VibrationLevel
from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import SETTLED, Array, Effect, Span, Survey
from hgma_compensation.effects.registry import register
from hgma_compensation.effects.requirements import require_channel


@register
@dataclass(frozen=True)
class VibrationRectification(Effect):
    """k·LPτ(v), v half the squared successive difference of the acceleration (term: IEEE Std 1293).

    That is von Neumann's mean square successive difference (1941), which is deaf to slow drift, less its ``floor``.
    """

    time_constant: float
    floor: float
    channel: str

    name = "vibration_rectification"
    title = "vibration rectification"
    spans: ClassVar[dict[str, Span]] = {
        "time_constant": Span("s", 0.5, 600.0),
        "floor": Span("(m/s^2)^2", 0.0, 1e14, searched=False),
    }
    identified_by = "vibration switched on and off"
    confused_with = ("quadratic_nonlinearity",)
    gain_unit = "/(m/s^2)^2"
    per_sample = True
    folds_in_time = True

    def check(self) -> None:
        """Refuse parameters outside their spans, and what is not a channel."""
        super().check()
        require_channel("channel", self.channel)

    def acceleration_memory(self) -> VibrationLevel:
        """Return the level of the vibration."""
        return VibrationLevel(self.time_constant, self.floor)

    @property
    def settling(self) -> float:
        """Three time constants."""
        return SETTLED * self.time_constant

    @property
    def count(self) -> int:
        """One column."""
        return 1

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return the mean square of the vibration, (m/s²)²."""
        return state[:, :1]

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["VibrationRectification"]:
        """Yield time constants from a second to two minutes; none where nothing vibrated."""
        if survey.vibration:
            for time_constant in np.geomspace(1.0, 120.0, 8):
                yield cls(float(time_constant), survey.noise**2, survey.channel)
