"""From the effects wanted and the oven to a programme; effects that the time is too short for are dropped by name."""

from collections.abc import Sequence
from math import sqrt
from typing import Any

from hgma_compensation.errors import RefusedError
from hgma_compensation.programme import rules
from hgma_compensation.programme.activities import happenings
from hgma_compensation.programme.programme import Dropped, Programme, Wishes
from hgma_compensation.programme.rules import demand_of
from hgma_compensation.programme.steps import Part, PlannedStep


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
