"""When what is done beside heating: places in each step, so that nothing follows temperature or rate by chance.

Sizes repeat with a period that shares no divisor with cooling and heating, and each activity has places of its own.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

from hgma_compensation.programme.rules import Activity
from hgma_compensation.programme.steps import PlannedStep

OFF = 900.0
"""s without power, so that a warm-up of ten minutes begins nearly anew."""

LONGEST_SHARE = 0.15
"""Of a step's length that power is off or heat is given at most."""

HELD = 32.0
"""s that a level is held: six means of 5 s."""


@dataclass(frozen=True)
class Happening:
    """One activity. time, duration: s. size: share of what the activity does at most, signed."""

    activity: Activity
    time: float
    duration: float
    size: float

    def as_json(self) -> dict[str, Any]:
        """Return the figures."""
        return {
            "activity": self.activity.name.lower(),
            "time_s": self.time,
            "duration_s": self.duration,
            "size": self.size,
        }


Step = tuple[float, float]
"""Begin and length of a step, s."""


def happenings(steps: Sequence[PlannedStep], activities: Collection[Activity | None]) -> tuple[Happening, ...]:
    """Return what is to be done in steps, in order of time."""
    lengths = [60.0 * step.duration for step in steps]
    spans = list(zip(accumulate([0.0, *lengths]), lengths, strict=False))
    made = [one for activity in Activity if activity in activities for one in _PLACES[activity](spans)]
    return tuple(sorted(made, key=lambda one: one.time))


def _repeated(
    activity: Activity, places: Sequence[float], sizes: Sequence[float], seconds: float
) -> Callable[[Sequence[Step]], Iterator[Happening]]:
    """Return what puts an activity at shares of the length of every step, with sizes in turn."""

    def make(spans: Sequence[Step]) -> Iterator[Happening]:
        times = [(begin + place * length, length) for begin, length in spans for place in places]
        for number, (time, length) in enumerate(times):
            yield Happening(activity, time, min(seconds, LONGEST_SHARE * length), sizes[number % len(sizes)])

    return make


def _power(spans: Sequence[Step]) -> Iterator[Happening]:
    """Yield a pause in every step but the first: the recording begins with a power-on anyway."""
    for begin, length in spans[1:]:
        yield Happening(Activity.POWER, begin + 0.75 * length, min(OFF, LONGEST_SHARE * length), 1.0)


_PLACES: dict[Activity, Callable[[Sequence[Step]], Iterator[Happening]]] = {
    Activity.POWER: _power,
    Activity.SUPPLY: _repeated(Activity.SUPPLY, (0.35, 0.7), (1.0, -0.5, 0.0, -1.0, 0.5), 0.0),
    Activity.HEATING: _repeated(Activity.HEATING, (0.25, 0.5), (1.0, -0.8, 0.6), 600.0),
    Activity.LATERAL: _repeated(Activity.LATERAL, (0.2, 0.45, 0.7), (1.0, -0.4, -0.9, 0.2, 0.6), 0.0),
    Activity.LEVELS: _repeated(Activity.LEVELS, (0.12, 0.42, 0.62), (1.0, -0.66, 0.33, -1.0, 0.66, -0.33, 1.0), HELD),
    Activity.VIBRATION: _repeated(Activity.VIBRATION, (0.3, 0.55), (1.0, 0.3, 0.6), 480.0),
    Activity.SHOCKS: _repeated(Activity.SHOCKS, (0.4,), (1.0, -1.0, 0.5, -0.5), 0.8),
}
