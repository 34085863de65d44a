"""From sizes that would be named to a verdict on each effect, with its reason and what to record."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hgma_compensation.channels import group_of
from hgma_compensation.coverage.facts import Happened
from hgma_compensation.coverage.result import EffectCheck, Level, Parameter
from hgma_compensation.coverage.sensitivity import Point, Sensitivity, fraction
from hgma_compensation.coverage.trials import LARGER, MOST_LARGER, confirmed
from hgma_compensation.diagnosis.diagnose import FEWEST_SWEEPS
from hgma_compensation.diagnosis.forward import FOLLOWS
from hgma_compensation.diagnosis.polish import searched_parameter
from hgma_compensation.effects.effect import Effect, Need
from hgma_compensation.effects.hysteresis import Hysteresis
from hgma_compensation.effects.thermal_lag import ThermalLag
from hgma_compensation.quantities import counted, number
from hgma_compensation.training.train import SMALLEST_SPAN

OF_NOISE, OF_DRIFT = 3.0, 0.005
"""A size is small that is no more than so many times the noise of a mean of 10 s, or such a share of the drift."""

WIDE = 1.0 / 3.0
"""Share of the parameters tried for which a small size must show: no recording shows the fastest and the slowest."""

LARGE = 10.0
"""Times a small size, beyond which an effect that needs it counts as not shown."""

FEWEST_EVENTS = 3
"""Power-ons or shocks below which nothing shows that an effect comes again with the next one."""

SHORTEST_AGING = 24.0
"""h: what a sensor does within a day is no more than the beginning of its aging."""

AVERAGED = (ThermalLag, Hysteresis)
"""Kinds that a diagnosis of fewer sweeps averages over."""

MISSING = {
    Need.TEMPERATURE_2: "no second thermometer (topic accel/temperature_2)",
    Need.SUPPLY_VOLTAGE: "no supply voltage (topic accel/supply_voltage)",
    Need.OTHER_AXIS: "no other axis of the acceleration",
}


@dataclass(frozen=True)
class Judge:
    """One channel's sensitivity, and what went on. inputs: those that all recordings have. small: what counts so.

    averaged: samples that were taken together.
    """

    sensitivity: Sensitivity
    happened: Happened
    inputs: frozenset[str]
    averaged: int
    sweeps: int
    small: float

    def effect(self, kind: type[Effect], random: np.random.Generator) -> EffectCheck:
        """Return the verdict on a kind of effect."""
        points = [point for point in self.sensitivity.points if isinstance(point.effect, kind)]
        absent = self._absent(kind, points)
        if absent:
            return EffectCheck(kind.name, Level.NOT, absent, _remedy(kind))
        typical = _typical(points, self.small)
        proven = confirmed(self.sensitivity.state, typical, random)
        if proven is None:
            reason = (
                f"not even {LARGER**MOST_LARGER:.0f} times the size that shows in the fit would predict the cycles or "
                "stretches of time left out of it"
            )
            return EffectCheck(kind.name, Level.NOT, reason, _remedy(kind))
        level = self._level(points, proven.size / typical.size)
        reason, limited = self._reason(kind, proven)
        if limited:
            level = max(level, Level.WEAKLY, key=list(Level).index)
        return EffectCheck(
            kind.name,
            level,
            reason,
            "" if level is Level.IDENTIFIABLE else _remedy(kind),
            proven.size,
            _parameter(points, proven, self.small),
            proven.rival,
            proven.correlation,
        )

    def _absent(self, kind: type[Effect], points: Sequence[Point]) -> str:
        """Return why an effect cannot show at all, "" where it can."""
        for need in kind.needs:
            if not self._has(need):
                return MISSING[need]
        if kind.per_sample and self.averaged > 1:
            return (
                f"the recordings are so long that {self.averaged} samples are taken together, which hides single ones: "
                "check a part with --from and --until"
            )
        if kind.input_driven and not self.sensitivity.state.problem.survey.inputs:
            return "no level of real acceleration that comes again and again"
        if kind.name == "vibration_rectification" and not self.happened.vibrating:
            return "the noise of the channel never changes: nothing vibrates"
        if kind.name == "post_shock_zero_shift" and not self.happened.shocks:
            return "no shock"
        span = float(np.ptp(self.sensitivity.state.problem.features[:, 0]))
        if span < SMALLEST_SPAN and not kind.folds_in_time and not kind.needs:
            return f"the temperature changes by {span:.2g} °C only"
        if self.sweeps < FEWEST_SWEEPS and kind not in AVERAGED:
            return f"{self.sweeps} coolings and heatings to learn from, {FEWEST_SWEEPS} are needed to leave a cycle out"
        if not points and self.sensitivity.follows(kind):
            return FOLLOWS
        return "" if points else "nothing sets it off beyond what a model of temperature and rate carries"

    def _has(self, need: Need) -> bool:
        if need is Need.OTHER_AXIS:
            others = self.sensitivity.state.problem.survey.others
            return any(group_of(other) == "linear_acceleration" for other in others)
        return need.value in self.inputs

    def _level(self, points: Sequence[Point], raised: float) -> Level:
        """Return the level; raised: by how much left-out data ask for more than the search does."""
        if fraction(points, self.small / raised) >= WIDE:
            return Level.IDENTIFIABLE
        return Level.WEAKLY if fraction(points, LARGE * self.small / raised) > 0.0 else Level.NOT

    def _reason(self, kind: type[Effect], point: Point) -> tuple[str, bool]:
        """Return what there is in numbers, and whether that limits the verdict whatever the size."""
        power_ons, shocks, hours = self.happened.power_ons, self.happened.shocks, self.happened.hours
        if self.sweeps < FEWEST_SWEEPS:
            return f"{self.sweeps} sweeps: averaged with other memories, none is named by itself", True
        if kind.name == "warm_up":
            few = power_ons < FEWEST_EVENTS
            return f"{counted(power_ons, 'power-on')}{', which says little of the next one' if few else ''}", few
        if kind.name == "post_shock_zero_shift":
            return counted(shocks, "shock"), shocks < FEWEST_EVENTS
        if kind.name == "aging":
            few = hours < SHORTEST_AGING
            later = ", which says little of later days" if few else ""
            return f"{hours:.3g} h, {number(float(np.ptp(point.values)) / hours, 3)} an hour{later}", few
        return ("", False) if kind.folds_in_time or kind.needs or kind.input_driven else (self._excitation(), False)

    def _excitation(self) -> str:
        rates = self.happened.rates
        if not rates:
            return "no ramp"
        said = f"{counted(len(rates), 'ramp rate')}, {', '.join(f'{rate:.2g}' for rate in rates)} °C/min"
        return f"{counted(self.sweeps, 'sweep')} at {said}"


def _typical(points: Sequence[Point], small: float) -> Point:
    """Return the point in the middle of those that show at a small size, the best one where none does."""
    good = [point for point in points if point.size <= small]
    return good[len(good) // 2] if good else min(points, key=lambda point: point.size)


def _parameter(points: Sequence[Point], point: Point, small: float) -> Parameter | None:
    """Return the parameter that is looked for, with the range in which the effect shows at ten times a small size."""
    name = searched_parameter(point.effect)
    if name is None:
        return None
    reach = max(small, point.size)
    values = [float(getattr(p.effect, name)) for p in points if p.size <= reach] or [float(getattr(point.effect, name))]
    return Parameter(name, point.effect.spans[name].unit, float(getattr(point.effect, name)), min(values), max(values))


def _remedy(kind: type[Effect]) -> str:
    return f"record {kind.identified_by}" if kind.identified_by else ""
