"""Samples of the accelerometer cut where its clock began anew."""

from collections.abc import Iterator

import numpy as np

from hgma_compensation.stamps import Stamps
from hgma_compensation.temperature.track import TIME_JUMP


class Stretches:
    """Cuts before each stamp that lies more than TIME_JUMP before the newest (a bag that loops).

    newest: latest stamp since the last cut, ns. jumps_back: number of cuts so far.
    """

    def __init__(self) -> None:
        """Start before any sample."""
        self.newest: int | None = None
        self.jumps_back = 0

    def split(self, stamps: Stamps, longest: int) -> Iterator[tuple[slice, bool]]:
        """Yield the rows of each stretch of at most ``longest`` samples, and whether there is a cut before it."""
        start, anew = 0, False
        while start < len(stamps):
            end = min(start + longest, len(stamps))
            before = stamps[start] if self.newest is None else self.newest
            newest = np.maximum.accumulate(np.concatenate([[before], stamps[start:end]]))
            jumps = np.flatnonzero(stamps[start:end] < newest[:-1] - TIME_JUMP)
            stop = start + int(jumps[0]) if len(jumps) else end
            self.newest = int(newest[stop - start])
            if stop > start:
                yield slice(start, stop), anew
                anew = False
            if len(jumps):
                self.jumps_back += 1
                self.newest, anew = None, True
            start = stop
