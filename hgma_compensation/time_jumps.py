"""What a step back of a stream's stamps means, the same for every stream.

Small steps are late messages. A step to where the stream's time began, or before it, is a new beginning: a bag that
loops, a simulation that restarts. A step into its midst is a clock that was corrected while the sensor went on.
"""

from enum import Enum

from hgma_compensation.stamps import NANOSECONDS

TIME_JUMP = 5 * NANOSECONDS
"""A step back by more than this is a jump, by less a late message."""

LONGEST_CORRECTION = 3600 * NANOSECONDS
"""A step back by more than this is a new beginning wherever it leads: no sensor's past is told apart that far."""

RECALL = 60 * NANOSECONDS
"""Time after a step ahead within which a step back to before it shows that the clock had been wrong."""


class StepBack(Enum):
    """What a stamp means that is not later than the newest one."""

    LATE = "late"
    CORRECTED = "corrected"
    ANEW = "anew"


def step_back(stamp: int, newest: int, first: int) -> StepBack:
    """Return what a stamp (ns) means to a stream that has come from ``first`` to ``newest``."""
    if newest - stamp <= TIME_JUMP:
        return StepBack.LATE
    if stamp <= first + TIME_JUMP or newest - stamp > LONGEST_CORRECTION:
        return StepBack.ANEW
    return StepBack.CORRECTED
