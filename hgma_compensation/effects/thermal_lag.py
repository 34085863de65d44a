"""Thermal lag: the structure follows the thermistor's temperature late."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from hgma_compensation.effects.conditions import Conditions
from hgma_compensation.effects.effect import SETTLED, Array, Effect, Span, Survey
from hgma_compensation.effects.memory import LowPass
from hgma_compensation.effects.registry import register
from hgma_compensation.effects.requirements import geometric, require_whole
from hgma_compensation.effects.static_map import FINE, MAP_SPANS, check_map, map_difference


@register
@dataclass(frozen=True)
class ThermalLag(Effect):
    """f(LPτ T) − f(T), LPτ a one-pole low-pass (first-order instrument; Doebelin, Measurement Systems, ch. 3).

    With several ``poles``, each is ``spread`` times slower than the one before, τ in their middle, and has a map of its
    own: a cascade is such a sum. The map f is linear plus ``centres`` Gaussians over lowest…highest, °C, which are the
    ends of the map.
    """

    time_constant: float
    lowest: float
    highest: float
    centres: float = FINE
    spread: float = 1.0
    poles: float = 1.0

    name = "thermal_lag"
    title = "thermal lag of the structure behind the thermistor"
    slow = True
    spans: ClassVar[dict[str, Span]] = {
        "time_constant": Span("s", 1.0, 1500.0),
        **MAP_SPANS,
        "spread": Span("", 1.0, 10.0, searched=False),
        "poles": Span("", 1.0, 8.0, searched=False),
    }
    identified_by = "ramps at two rates or more, with sharp corners between ramps and soaks"
    confused_with = ("timing_offset", "thermal_gradient", "stress_relaxation")
    gain_unit = "/°C"

    def check(self) -> None:
        """Refuse parameters outside their spans, and those that make no map."""
        super().check()
        check_map(self.lowest, self.highest, self.centres)
        require_whole("poles", self.poles)

    def memory(self) -> LowPass:
        """Return the poles."""
        return LowPass(geometric(self.time_constant, self.spread, self.poles))

    @property
    def settling(self) -> float:
        """Three of the slowest pole's time constants."""
        return SETTLED * max(self.memory().time_constants)

    @property
    def count(self) -> int:
        """The linear column and the Gaussians, for each pole."""
        return self.memory().size * (1 + int(self.centres))

    def columns(self, at: Conditions, state: Array) -> Array:
        """Return what the map makes of the lag, °C."""
        map_of = partial(
            map_difference, temperature=at.temperature, lowest=self.lowest, highest=self.highest, centres=self.centres
        )
        return np.hstack([map_of(pole) for pole in state.T])

    def richer(self, survey: Survey) -> Iterator["ThermalLag"]:
        """Yield the lag seen through a map that bends."""
        if not self.centres and self.highest > self.lowest:
            yield replace(self, centres=FINE)
            yield replace(self, centres=FINE, spread=4.0, poles=2.0)
        elif self.centres and self.poles == 1.0:
            yield replace(self, spread=4.0, poles=2.0)

    @classmethod
    def candidates(cls, survey: Survey) -> Iterator["ThermalLag"]:
        """Yield time constants from what the data resolve to where creep begins."""
        shortest = min(max(1.0, 0.5 * survey.interval), 350.0)
        for time_constant in np.geomspace(shortest, 700.0, 14):
            yield cls(float(time_constant), survey.lowest, survey.highest, 0.0)
