"""Timing offset: the thermistor's stamps run ahead of the accelerometer's."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import Array, Effect, Span, Survey
from hgma_compensation.effects.registry import register
from hgma_compensation.effects.static_map import FINE, MAP_SPANS, check_map, map_difference


@register
@dataclass(frozen=True)
class TimingOffset(Effect):
    """f(T(t − delay)) − f(T(t)) (EFFECTS catalogue form), the map f as that of thermal_lag."""

    delay: float
    lowest: float
    highest: float
    centres: float = FINE

    name = "timing_offset"
    title = "offset between the stamps of thermistor and accelerometer"
    slow = True
    spans: ClassVar[dict[str, Span]] = {"delay": Span("s", 0.1, 120.0), **MAP_SPANS}
    identified_by = "sharp corners between ramps and soaks, or the ripple of an oven's controller"
    confused_with = ("thermal_lag", "thermal_gradient")
    gain_unit = "/°C"

    def check(self) -> None:
        """Refuse parameters outside their spans, and those that make no map."""
        super().check()
        check_map(self.lowest, self.highest, self.centres)

    @property
    def history(self) -> float:
        """The delay."""
        return self.delay

    @property
    def count(self) -> int:
        """The linear column and the Gaussians."""
        return 1 + int(self.centres)

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return what the map makes of the delay, °C."""
        return map_difference(at.earlier(self.delay), at.temperature, self.lowest, self.highest, self.centres)

    def richer(self, survey: Survey) -> Iterator["TimingOffset"]:
        """Yield the delay seen through a map that bends."""
        if not self.centres and self.highest > self.lowest:
            yield replace(self, centres=FINE)

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["TimingOffset"]:
        """Yield delays from half a second to a minute."""
        for delay in np.geomspace(0.5, 60.0, 12):
            yield cls(float(delay), survey.lowest, survey.highest, 0.0)
