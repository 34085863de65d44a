"""Samples of the accelerometer cut where its clock did more than go on."""

from collections.abc import Iterator
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps
from hgma_compensation.temperature.updates import POWER_OFF
from hgma_compensation.time_jumps import RECALL, TIME_JUMP, StepBack, step_back


class Cut(Enum):
    """What happened before a stretch.

    GAP: no sample for a while, or a clock that steps ahead. PAUSE: one so long that the sensor was off. ANEW: a new
    time line, such as a bag that loops. SET_BACK: the clock was corrected. RECALLED: the gap before was none, the clock
    had been wrong.
    """

    NONE = "none"
    GAP = "gap"
    PAUSE = "acceleration_paused"
    ANEW = "acceleration_time_jumped_back"
    SET_BACK = "acceleration_clock_set_back"
    RECALLED = "acceleration_clock_was_ahead"


_STEPS_BACK = {StepBack.ANEW: Cut.ANEW, StepBack.CORRECTED: Cut.SET_BACK}


class Stretches:
    """Follows the stamps; newest: latest one of this time line, ns."""

    def __init__(self) -> None:
        """Start before any sample."""
        self.reset()

    def reset(self) -> None:
        """Forget all stamps."""
        self.newest: int | None = None
        self._first = 0
        self._gap: tuple[int, int] | None = None

    def snapshot(self) -> list[int | None]:
        """Return the stamps of beginning and end of the time line as plain JSON."""
        return [self._first, self.newest]

    def restore(self, snapshot: list[int | None]) -> None:
        """Go on from a snapshot; raises ValueError or TypeError where it is none."""
        self.reset()
        first, newest = snapshot
        if newest is not None:
            self._first, self.newest = int(first or 0), int(newest)

    def go_on(self, stamps: Stamps) -> bool:
        """Move on to increasing stamps (n > 0,) if they do nothing but go on, and return whether they do."""
        first, last = int(stamps[0]), int(stamps[-1])
        if not self.only_go_on(first, last):
            return False
        self.newest = last
        return True

    def only_go_on(self, first: int, last: int) -> bool:
        """Return whether stamps that increase, ``first`` to ``last`` (ns), go on from those before without a gap."""
        return self.newest is not None and self.newest < first and last <= self.newest + TIME_JUMP

    def split(self, stamps: Stamps, longest: int) -> Iterator[tuple[slice, Cut]]:
        """Yield the rows of each stretch of at most ``longest`` samples, and what happened before it."""
        start = 0
        while start < len(stamps):
            cut = self._enter(int(stamps[start]))
            stop = start + self._until_cut(stamps[start : start + longest])
            yield slice(start, stop), cut
            start = stop

    def _enter(self, stamp: int) -> Cut:
        """Take the first stamp of a stretch and say what happened before it."""
        cut = Cut.NONE if self.newest is None else self._meaning(stamp, self.newest)
        if self.newest is None or cut is Cut.ANEW:
            self._first, self.newest = stamp, stamp
        elif cut is Cut.SET_BACK:
            self._first -= self.newest - stamp
            self.newest = stamp
        elif cut is Cut.RECALLED:
            assert self._gap is not None
            self.newest = max(self._gap[0], stamp)
        elif cut in (Cut.GAP, Cut.PAUSE):
            self._gap = (self.newest, stamp)
        if cut in (Cut.ANEW, Cut.SET_BACK, Cut.RECALLED):
            self._gap = None
        return cut

    def _meaning(self, stamp: int, newest: int) -> Cut:
        if stamp - newest > TIME_JUMP:
            return Cut.PAUSE if stamp - newest > POWER_OFF else Cut.GAP
        if newest - stamp <= TIME_JUMP:
            return Cut.NONE
        soon = self._gap is not None and newest - self._gap[1] <= RECALL
        if soon and self._gap is not None and stamp >= self._gap[0] - TIME_JUMP:
            return Cut.RECALLED
        return _STEPS_BACK[step_back(stamp, newest, self._first)]

    def _until_cut(self, stamps: Stamps) -> int:
        """Return how many of the stamps belong to the stretch that begins with the first, and move on to them."""
        assert self.newest is not None
        if len(stamps) == 1:
            self.newest = max(self.newest, int(stamps[0]))
            return 1
        newest = np.maximum(np.maximum.accumulate(stamps), self.newest)
        cuts = np.flatnonzero(_cuts(stamps[1:], newest[:-1]))
        count = int(cuts[0]) + 1 if len(cuts) else len(stamps)
        self.newest = int(newest[count - 1])
        return count


def _cuts(stamps: Stamps, newest: Stamps) -> NDArray[np.bool_]:
    return np.asarray((stamps < newest - TIME_JUMP) | (stamps - newest > TIME_JUMP))
