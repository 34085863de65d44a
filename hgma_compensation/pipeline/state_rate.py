"""Which samples a state is published for: a bounded number of them in a second, and each one that changes something.

A state costs more than the sample it describes. Which ones there are is decided by stamps and statuses alone, so that
the node and the offline commands choose the same ones.
"""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps, to_nanoseconds

DEFAULT_RATE = 20.0
"""States in a second of stamps; 0 for one with every sample."""


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
        changes = np.flatnonzero((status[1:] != status[:-1]) | (inside[1:] != inside[:-1])) + 1
        while row < len(stamps):
            if self.wants(int(stamps[row]), int(status[row]), bool(inside[row])):
                rows.append(row)
            row = self._next(stamps, row + 1, changes)
        if len(stamps):
            self._before = (int(status[-1]), bool(inside[-1]))
        return np.array(rows, dtype=np.int64)

    def _next(self, stamps: Stamps, row: int, changes: NDArray[np.int64]) -> int:
        """Return the first row from ``row`` on that is chosen, n where there is none."""
        assert self._chosen is not None
        place = int(changes.searchsorted(row))
        end = int(changes[place]) if place < len(changes) else len(stamps)
        step = 256
        while row < end:
            due = np.abs(stamps[row : min(row + step, end)] - self._chosen) >= self._period
            if due.any():
                return row + int(due.argmax())
            row, step = row + step, 2 * step
        return end
