"""What is wished for of an oven programme, and the programme itself."""

from dataclasses import dataclass
from itertools import accumulate
from math import isfinite
from typing import Any

from hgma_compensation.errors import RefusedError
from hgma_compensation.programme import rules
from hgma_compensation.programme.activities import Happening
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
