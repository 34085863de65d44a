"""Single samples of the accelerometer, window by window: rate, gaps, and values at a limit of the sensor's range."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.stamps import NANOSECONDS, Stamps

Array = NDArray[np.float64]

GAP = 5.0
"""Intervals without a sample that count as a gap: a late message or two are none."""

RUN = 5
"""Equal samples in a row at an extreme value that show a clipped sensor ..."""

SELDOM = 0.2
"""... where no more than this share of successive samples are equal elsewhere, so that noise is above a count."""


class SampleSurvey:
    """What is counted of the samples; windows in their order, of any lengths, which change nothing."""

    def __init__(self) -> None:
        """Start without samples."""
        self.samples = self.gaps = 0
        self.longest_gap = 0.0
        self._interval = 0
        self._last: tuple[int, Array] | None = None
        self._first = 0
        width = len(CHANNELS)
        self.lowest, self.highest = np.full(width, np.inf), np.full(width, -np.inf)
        self._equal = np.zeros(width, dtype=np.int64)
        # For each limit: samples that stand at it, and those of them whose predecessor does as well.
        self._at = np.zeros((2, width), dtype=np.int64)
        self._again = np.zeros((2, width), dtype=np.int64)

    def add(self, stamps: Stamps, values: Array) -> None:
        """Take samples: stamps (n,) in ns, values (n, 6)."""
        if not len(stamps):
            return
        self._first = self._first or int(stamps[0])
        if self._last is not None:
            stamps, values = np.append(self._last[0], stamps), np.vstack([self._last[1], values])
        new = len(stamps) - (self._last is not None)
        steps = np.diff(stamps)
        if not self._interval and len(steps):
            self._interval = max(1, int(np.median(steps)))
        gaps = steps[steps > GAP * self._interval] if self._interval else steps[:0]
        self.gaps += len(gaps)
        self.longest_gap = max(self.longest_gap, float(gaps.max(initial=0)) / NANOSECONDS)
        self.samples += new
        same = values[1:] == values[:-1]
        self._equal += same.sum(axis=0)
        self._extremes(values[len(values) - new :], values, same)
        self._last = int(stamps[-1]), values[-1].copy()

    def _extremes(self, new: Array, values: Array, same: NDArray[np.bool_]) -> None:
        finite = np.where(np.isfinite(new), new, np.nan)
        with np.errstate(all="ignore"):
            ends = np.fmin.reduce(finite, axis=0), np.fmax.reduce(finite, axis=0)
        for side, (known, end) in enumerate(zip((self.lowest, self.highest), ends, strict=True)):
            further = end < known if side == 0 else end > known
            self._at[side, further] = self._again[side, further] = 0
            known[further] = end[further]
            self._at[side] += (new == known).sum(axis=0)
            self._again[side] += (same & (values[1:] == known)).sum(axis=0)

    @property
    def rate(self) -> float:
        """Samples in a second, pauses left out."""
        return NANOSECONDS / self._interval if self._interval else 0.0

    def clipped(self, channel: str) -> int:
        """Return how many samples of a channel stand at a limit of the sensor's range, 0 where there is none."""
        column = CHANNELS.index(channel)
        pairs = max(self.samples - 1, 1)
        count = 0
        for side in range(2):
            elsewhere = (self._equal[column] - self._again[side, column]) / pairs
            if self._again[side, column] >= RUN - 1 and elsewhere < SELDOM:
                count += int(self._at[side, column])
        return count
