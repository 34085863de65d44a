"""Time steps of the Kalman stage, out of stamps in whole nanoseconds."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps, seconds_between

Array = NDArray[np.float64]

ROUNDING = 1
"""ns by which steps of one even interval differ: those of 3 kHz are 333 333 and 333 334 ns."""

UNKNOWN = -1 - ROUNDING
"""ns of an interval before there is one: no step is as long within the rounding."""

PAUSE = 10.0
"""Times the interval before: a longer one is a pause, in which the level went on and no sample was taken."""

SECONDS = 1e-9
"""In a nanosecond."""


class Steps(NamedTuple):
    """For n samples: dt, s since the one before, 0 where there is none; averaged, s that a sample is the mean of.

    Both are numbers where they are the same for all samples, (n,) else.
    """

    dt: float | Array
    averaged: float | Array

    def part(self, start: int, stop: int) -> "Steps":
        """Return those of some of the samples."""
        if isinstance(self.dt, float) or isinstance(self.averaged, float):
            return self  # both are
        return Steps(self.dt[start:stop], self.averaged[start:stop])

    def at(self, index: int) -> tuple[float, float]:
        """Return both for one sample."""
        if isinstance(self.dt, float) or isinstance(self.averaged, float):
            return float(self.dt), float(self.averaged)
        return float(self.dt[index]), float(self.averaged[index])

    def each(self, count: int) -> tuple[Array, Array]:
        """Return both as arrays (n,)."""
        if isinstance(self.dt, float) or isinstance(self.averaged, float):
            return np.full(count, self.dt), np.full(count, self.averaged)
        return self.dt, self.averaged


class Intervals:
    """Newest stamp and interval of a stream.

    The interval stands as long as steps differ from the one that set it by no more than ROUNDING: so an even stream has
    one interval, and the filter's gain settles. That takes R and Q wrong by no more than 1 ns in the interval, which is
    1e-3 of it at 1 MHz and 1e-5 at 10 kHz; the gain, √(Q/R) = q dt/N, is wrong by as much.
    """

    def __init__(self) -> None:
        """Start without a stamp."""
        self.reset()

    def reset(self) -> None:
        """Forget every stamp."""
        self.newest, self._held = 0, UNKNOWN
        self._averaged = 0.0

    def step(self, stamp: int) -> tuple[float, float]:
        """Take one stamp (ns); return dt and averaged as Steps has them."""
        step = stamp - self.newest
        if step <= 0:
            return 0.0, self._averaged
        self.newest = stamp
        if not -ROUNDING <= step - self._held <= ROUNDING:
            self._held = step
        dt = self._held * SECONDS
        # No pause belongs to a sample. Moves on to another sampling rate within a few samples.
        longest = PAUSE * self._averaged
        self._averaged = dt if longest == 0.0 or dt <= longest else longest
        return dt, self._averaged

    def steps(self, stamps: Stamps) -> Steps:
        """Take stamps (n,), n > 0; the same numbers as one by one."""
        ns = np.empty(len(stamps), dtype=np.int64)
        ns[0] = stamps[0] - self.newest
        np.subtract(stamps[1:], stamps[:-1], out=ns[1:])
        shortest, longest = int(np.minimum.reduce(ns)), int(np.maximum.reduce(ns))
        as_before = self._averaged == self._held * SECONDS
        if max(self._held - ROUNDING, 1) <= shortest and longest <= self._held + ROUNDING and as_before:
            self.newest = int(stamps[-1])
            return Steps(self._averaged, self._averaged)
        if shortest > 0:
            held = hold_steps(ns, self._held)
            dt = seconds_between(held, 0)
            if (dt <= PAUSE * np.concatenate([[self._averaged], dt[:-1]])).all():
                self.newest, self._held, self._averaged = int(stamps[-1]), int(held[-1]), float(dt[-1])
                return Steps(dt, dt)
        each: Array = np.array([self.step(stamp) for stamp in stamps.tolist()])
        return Steps(each[:, 0], each[:, 1])


def hold_steps(ns: NDArray[np.int64], held: int = UNKNOWN) -> NDArray[np.int64]:
    """Return the steps (n,) that count for steps (n,) after one that counted as ``held``, in ns."""
    if not len(ns):
        return ns
    starts = np.append(0, np.flatnonzero(ns[1:] != ns[:-1]) + 1)
    counting = []
    lowest, highest = held - ROUNDING, held + ROUNDING
    for step in ns[starts].tolist():
        if not lowest <= step <= highest:
            held, lowest, highest = step, step - ROUNDING, step + ROUNDING
        counting.append(held)
    return np.repeat(np.array(counting, dtype=np.int64), np.diff(np.append(starts, len(ns))))
