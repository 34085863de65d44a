"""Stamps of samples that could not be used, so that a reading knows that the newest one was such."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps

MOST = 4096
"""Stamps that a stream holds on to: more than a minute of them at any rate of a thermistor."""


class UnusableStamps:
    """Increasing stamps in ns; those that do not increase say nothing new."""

    def __init__(self, *, bounded: bool) -> None:
        """Start empty; bounded: forget the oldest of many."""
        self._bounded = bounded
        self.clear()

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._stamps)

    def clear(self) -> None:
        """Forget all stamps."""
        self._stamps = np.empty(0, dtype=np.int64)

    def note(self, stamp: int) -> None:
        """Take the stamp of an unusable sample."""
        stamps = self._stamps
        if len(stamps) and stamp <= stamps[-1]:
            return
        oldest = len(stamps) // 2 if self._bounded and len(stamps) >= MOST else 0
        self._stamps = np.append(stamps[oldest:], np.int64(stamp))

    def forget_after(self, stamp: int) -> None:
        """Drop the stamps later than one."""
        self._stamps = self._stamps[: self._stamps.searchsorted(stamp, side="right")]

    def shift(self, nanoseconds: int) -> None:
        """Move all stamps."""
        self._stamps = self._stamps + nanoseconds

    def between(self, low: int, high: int) -> Stamps:
        """Return the stamps in low < s < high, ns."""
        stamps = self._stamps
        return stamps[stamps.searchsorted(low, side="right") : stamps.searchsorted(high)]

    def at_or_after(self, used: Stamps, counted: Stamps) -> NDArray[np.bool_]:
        """Return (n,) whether the newest at ``counted`` (n,) is not older than ``used`` (n,); there must be one."""
        index = self._stamps.searchsorted(counted, side="right") - 1
        return np.asarray((index >= 0) & (self._stamps[np.maximum(index, 0)] >= used))
