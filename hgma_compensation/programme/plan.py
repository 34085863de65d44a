"""From the effects wanted and the oven to a programme; effects that the time is too short for are dropped by name."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from math import isfinite, sqrt
from typing import Any

from hgma_compensation.errors import RefusedError
from hgma_compensation.programme import rules
from hgma_compensation.programme.activities import Happening, happenings
from hgma_compensation.programme.rules import Activity, demand_of
from hgma_compensation.programme.steps import Part, PlannedStep


@dataclass(frozen=True)
class Wishes:
    """effects: names. lowest, highest: °C. ramp_rate: the oven's fastest, mission_rate: the robot's, °C/min.

    time_constant: s, of the memories looked for, None where not known. hours: available, None for any.
    """

    effects: tuple[str, ...] = rules.OVEN_ALONE
    lowest: float = -10.0
    highest: float = 60.0
    ramp_rate: float = 2.0
    mission_rate: float = 1.0
    time_constant: float | None = None
    hours: float | None = None

    def check(self) -> None:
        """Raise RefusedError, naming the option, for what no oven can do."""
        for option, value in (
            ("--from", self.lowest),
            ("--to", self.highest),
            ("--ramp-rate", self.ramp_rate),
            ("--mission-rate", self.mission_rate),
            ("--time-constant", self.time_constant or 0.0),
            ("--hours", self.hours or 0.0),
        ):
            if not isfinite(value):
                raise RefusedError(f"{option} is {value}: give a number")
        if self.highest - self.lowest < rules.LEAST_SPAN:
            raise RefusedError(
                f"--from {self.lowest:g} --to {self.highest:g}: the range must rise by {rules.LEAST_SPAN:g} °C at "
                "least: give the range that the sensor will see"
            )


@dataclass(frozen=True)
class Dropped:
    """An effect that the hours available are too few for. hours: that it would take beside those kept."""

    name: str
    hours: float


@dataclass(frozen=True)
class Programme:
    """steps: in their order. effects: that it is for. dropped: that it is not for, though they were wished for.

    happenings: what is done beside heating, in order of time. notes: what else the user must know.
    """

    wishes: Wishes
    effects: tuple[str, ...]
    steps: tuple[PlannedStep, ...]
    happenings: tuple[Happening, ...]
    dropped: tuple[Dropped, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Length in min: the sum of the steps'."""
        return sum(step.duration for step in self.steps)

    @property
    def starts(self) -> tuple[float, ...]:
        """When each step begins, min."""
        return (0.0, *accumulate(step.duration for step in self.steps[:-1]))

    @property
    def hold_out(self) -> float:
        """When the hold-out begins, min."""
        return next(t for t, step in zip(self.starts, self.steps, strict=True) if step.part is Part.HOLD_OUT)

    @property
    def activities(self) -> tuple[Activity, ...]:
        """What is done beside heating."""
        return tuple(a for a in Activity if any(demand_of(name).activity is a for name in self.effects))

    def as_json(self) -> dict[str, Any]:
        """Return the figures."""
        return {
            "effects": list(self.effects),
            "dropped": {one.name: {"hours": one.hours} for one in self.dropped},
            "steps": [step.as_json() for step in self.steps],
            "duration_min": self.duration,
            "hold_out_from_s": 60.0 * self.hold_out,
            "accelerometer_rate_hz": rules.ACCELEROMETER_RATE,
            "thermistor_rate_hz": rules.THERMISTOR_RATE,
            "happenings": [one.as_json() for one in self.happenings],
            "notes": list(self.notes),
        }


def plan(wishes: Wishes) -> Programme:
    """Return the programme for all effects wished for, or for as many as the hours suffice for.

    Raises RefusedError where they do not suffice for two cycles and a hold-out.
    """
    wishes.check()
    kept, dropped = tuple(wishes.effects), []
    while wishes.hours is not None and (too_long := _hours(wishes, kept) - wishes.hours) > 0.0:
        savings = {name: _hours(wishes, kept) - _hours(wishes, _without(kept, name)) for name in kept}
        useful = {name: saving for name, saving in savings.items() if saving > 1e-9}
        if not useful:
            least = _hours(wishes, kept)
            raise RefusedError(
                f"--hours {wishes.hours:g}: two cycles and a hold-out take {least:.1f} h: allow them, or give a "
                "narrower range (--from, --to) or a faster oven (--ramp-rate, --mission-rate)"
            )
        # The least that is enough; where no single one is, the longest, so that as few as possible go.
        enough = [name for name, saving in useful.items() if saving >= too_long]
        name = min(enough, key=lambda n: useful[n]) if enough else max(useful, key=lambda n: useful[n])
        dropped.append(Dropped(name, useful[name]))
        kept = _without(kept, name)
    steps = _steps(wishes, kept)
    activities = {demand_of(name).activity for name in kept}
    return Programme(wishes, kept, steps, happenings(steps, activities), tuple(dropped), _notes(wishes, kept))


def rates(wishes: Wishes, effects: Sequence[str]) -> tuple[float, ...]:
    """Return the rates of the cycles to learn from, °C/min: slow, fast, and a third where an effect asks for it."""
    fast = min(wishes.ramp_rate, max(rules.USUAL_RATE, rules.MARGIN * wishes.mission_rate))
    third = any(demand_of(name).rates > 2 for name in effects)
    slow = fast / rules.RATIO
    return (slow, fast, rules.THIRD * slow) if third else (slow, fast)


def soak_for(wishes: Wishes, effects: Sequence[str]) -> tuple[float, str]:
    """Return the soak at each end in min, and the effect that asks for it, "" for none."""
    longest, asked = rules.LEAST_SOAK, ""
    for name in effects:
        demand = demand_of(name)
        known = wishes.time_constant if wishes.time_constant is not None else demand.time_constant
        wanted = demand.soak * known / 60.0 if demand.soak else 0.0
        if wanted > longest:
            longest, asked = wanted, name
    return longest, asked


def _steps(wishes: Wishes, effects: Sequence[str]) -> tuple[PlannedStep, ...]:
    soak, asked = soak_for(wishes, effects)
    settle = f"come to rest ({asked})" if asked else "come to rest"
    low, high = wishes.lowest, wishes.highest
    cold, hot = low + rules.HOLD_OUT_INSIDE, high - rules.HOLD_OUT_INSIDE
    room = min(max(rules.ROOM, cold), hot)
    learned = rates(wishes, effects)
    hold = float(f"{sqrt(learned[0] * learned[1]):.2g}")  # nobody sets an oven to more digits
    steps = [PlannedStep(room, room, learned[1], max(rules.REST, soak), "equilibrium, noise", Part.LEARN)]

    def go(to: float, rate: float, wait: float, why: str, part: Part = Part.LEARN) -> None:
        steps.append(PlannedStep(steps[-1].to, to, rate, wait, why, part))

    for number, rate in enumerate(learned):
        words = ("slow cycle", "fast cycle: lag against hysteresis", "third rate: its power")[number]
        go(low, rate, soak, f"{words}; {settle}")
        go(high, rate, soak, f"{words}; {settle}")
        if number == 0:
            _between(effects, go, room, learned[1])
    if any(demand_of(name).loop for name in effects):
        inner, outer = (low + share * (high - low) for share in rules.LOOP)
        go(inner, learned[1], soak, "minor loop: a return point of its own")
        go(outer, learned[1], soak, "minor loop: a return point of its own")
    go(cold, hold, soak, "hold-out: a rate not learned from", Part.HOLD_OUT)
    go(hot, hold, soak, "hold-out: a rate not learned from", Part.HOLD_OUT)
    go(room, hold, rules.LEAST_SOAK, "hold-out: back", Part.HOLD_OUT)
    return tuple(steps)


def _between(effects: Sequence[str], go: Any, room: float, rate: float) -> None:
    """Add the rest between two cycles that the slowest effects ask for."""
    rest = max((demand_of(name).rest for name in effects), default=0.0)
    if rest:
        go(room, rate, 60.0 * rest, "rest, power on: what time alone does")


def _notes(wishes: Wishes, effects: Sequence[str]) -> tuple[str, ...]:
    fast = rates(wishes, effects)[1]
    notes = []
    if fast < wishes.mission_rate:
        notes.append(
            f"the oven's {fast:g} °C/min are slower than the mission's {wishes.mission_rate:g}: beyond the former the "
            "calibrated range ends, and the node holds the drift at its edge"
        )
    if "aging" in effects:
        notes.append("aging: a day shows its beginning; repeat the fast cycle after a week and diagnose both together")
    if "thermal_lag" in effects and "timing_offset" in effects:
        notes.append("thermal_lag and timing_offset look alike below a minute, whatever the programme: either will do")
    return tuple(notes)


def _hours(wishes: Wishes, effects: Sequence[str]) -> float:
    return sum(step.duration for step in _steps(wishes, effects)) / 60.0


def _without(names: tuple[str, ...], name: str) -> tuple[str, ...]:
    return tuple(other for other in names if other != name)
