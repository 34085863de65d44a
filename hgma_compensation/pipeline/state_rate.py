"""Which samples a state is published for: a bounded number of them in a second, and each one that changes something.

A state costs more than the sample it describes. Which ones there are is decided by stamps and statuses alone, so that
the node and the offline commands choose the same ones.
"""

from bisect import bisect_left

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.stamps import Stamps, to_nanoseconds

DEFAULT_RATE = 20.0
"""States in a second of stamps; 0 for one with every sample."""

ORDINARY = (int(TemperatureStatus.OK), True)
"""Status of a sample of which nothing is to be said, and that it lies in the calibrated range."""


class StateRate:
    """Follows the samples under one calibration, in the order in which they come."""

    def __init__(self, rate: float = DEFAULT_RATE) -> None:
        """Choose at most ``rate`` samples in a second besides those of change; 0 for all of them."""
        self._period = to_nanoseconds(1.0 / rate) if rate > 0.0 else 0
        self.reset()

    def reset(self) -> None:
        """Choose the next sample, whatever it is: another calibration is in use, or another time begins."""
        self._chosen: int | None = None
        self._before: tuple[int, bool] | None = None

    def rests(self, stamp: int) -> bool:
        """Return whether ``wants`` would not choose a sample at a stamp (ns) inside the range with the status OK."""
        chosen = self._chosen
        return chosen is not None and self._before == ORDINARY and abs(stamp - chosen) < self._period

    def wants(self, stamp: int, status: int, inside: bool) -> bool:
        """Take a sample (stamp in ns, TemperatureStatus, inside the calibrated range) and return if it is chosen.

        One is where there was none for a period, where the stamp is before that of the last one chosen by as much, and
        where status or range are not those of the sample before.
        """
        now = (status, inside)
        changed = now != self._before
        self._before = now
        if not changed and self._chosen is not None and abs(stamp - self._chosen) < self._period:
            return False
        self._chosen = stamp
        return True

    def choose(self, stamps: Stamps, status: NDArray[np.uint8], inside: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return the rows that are chosen of samples (n,), as ``wants`` does one after the other."""
        if not self._period:
            chosen = np.arange(len(stamps))
            if len(stamps):
                self.wants(int(stamps[-1]), int(status[-1]), bool(inside[-1]))
            return chosen
        rows: list[int] = []
        row = 0
        changes = (np.flatnonzero((status[1:] != status[:-1]) | (inside[1:] != inside[:-1])) + 1).tolist()
        rising = bool(
            (stamps[1:] >= stamps[:-1]).all() and (self._chosen is None or (stamps[:1] >= self._chosen).all())
        )
        times = stamps.tolist()
        while row < len(times):
            if self.wants(times[row], int(status[row]), bool(inside[row])):
                rows.append(row)
            place = bisect_left(changes, row + 1)
            end = changes[place] if place < len(changes) else len(times)
            assert self._chosen is not None
            # In stamps that rise the next one is found by halving; where the clock steps back each is looked at.
            due = self._chosen + self._period
            row = bisect_left(times, due, row + 1, end) if rising else self._next(stamps, row + 1, end)
        if len(stamps):
            self._before = (int(status[-1]), bool(inside[-1]))
        return np.array(rows, dtype=np.int64)

    def _next(self, stamps: Stamps, row: int, end: int) -> int:
        """Return the first row from ``row`` to before ``end`` that is due, ``end`` where there is none."""
        assert self._chosen is not None
        step = 256
        while row < end:
            due = np.abs(stamps[row : min(row + step, end)] - self._chosen) >= self._period
            if due.any():
                return row + int(due.argmax())
            row, step = row + step, 2 * step
        return end
