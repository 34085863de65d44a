"""Whether a state from before a restart is taken up: judged by stamps, when the first sample comes."""

from dataclasses import dataclass
from enum import Enum

from hgma_compensation.pipeline.live_state import LiveState
from hgma_compensation.time_jumps import TIME_JUMP


class Past(Enum):
    """What became of the state from before the start; the value is its name in the diagnostics."""

    NONE = "none"
    WAITING = "waiting_for_the_first_sample"
    TAKEN_UP = "taken_up"
    REPLAYED = "replayed"
    TOO_OLD = "state_too_old"
    FROM_LATER = "state_from_later_stamps"
    OTHER_SENSOR = "state_of_another_sensor"
    CLEARED = "cleared_by_reset"


DROPPED = {
    Past.TOO_OLD: "memories begin anew: expected after a long stop, else raise the parameter state_max_age",
    Past.FROM_LATER: "memories begin anew: expected when a bag or a simulation begins again, else check the clocks",
    Past.OTHER_SENSOR: "memories begin anew: give each sensor a state_file of its own",
}
"""Reasons for which a state is dropped, each with its remedy."""

SAID = {
    **{past: f"{past.value}: {remedy}" for past, remedy in DROPPED.items()},
    Past.TAKEN_UP: "the memories go on from the state file",
    Past.REPLAYED: "the state file is of another calibration: memories are built anew from the samples in it",
    Past.CLEARED: "the memories begin anew after a reset",
}
"""What there is to tell once it is decided."""


@dataclass(frozen=True)
class Offer:
    """A state that waits for the first sample, and the age in ns up to which it is taken up."""

    state: LiveState
    max_age: int

    def judge(self, source: str, stamp: int, sensor_id: str) -> Past:
        """Return TAKEN_UP, or why the state is dropped.

        source: name of the input whose sample came, with its stamp in ns. It is compared with the same input's newest
        stamp, because drivers may lag each other. sensor_id: of the calibration in use, "" without one.
        """
        stamps = self.state.newest()
        newest = stamps.get(source, max(stamps.values(), default=stamp))
        if sensor_id and self.state.sensor_id not in ("", sensor_id):
            return Past.OTHER_SENSOR
        if stamp < newest - TIME_JUMP:
            return Past.FROM_LATER
        return Past.TOO_OLD if stamp - newest > self.max_age else Past.TAKEN_UP
