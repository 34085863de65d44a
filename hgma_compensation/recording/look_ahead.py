"""Holds a bag's messages back until the slow inputs that belong to them have come.

A thermometer's message may be logged after accelerations that it belongs to. A recording is therefore compensated some
time behind the place that it is read at; how far is bounded, and so is the memory.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from hgma_compensation.effects.effect import Need
from hgma_compensation.recording.batch import Batch, Indices
from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.time_jumps import TIME_JUMP

LOOK_AHEAD = 60 * NANOSECONDS
"""Log time (ns) that is read ahead of an acceleration: a slow sample that is later than this comes late."""

MOST_HELD = 64 << 20
"""Bytes of messages that are held back; blocks of a fast sensor reach it before LOOK_AHEAD."""

MOST_SLOW = 1024
"""Samples of a slow input that are read ahead: what the pipeline remembers of broken ones is as bounded."""

LONGEST = 600 * NANOSECONDS
"""Log time of messages that are handed out at once."""


@dataclass(frozen=True)
class Slow:
    """Samples of a slow input in a batch, None for the thermistor; rows: (n,) of their messages."""

    need: Need | None
    series: Series
    rows: Indices


@dataclass(frozen=True)
class Held:
    """Messages with what the slow inputs among them say. steps_back: the first message is one of these, out of time."""

    batch: Batch
    slow: tuple[Slow, ...]
    steps_back: bool

    @property
    def count(self) -> int:
        """Number of samples of the slow input that has most."""
        return max((len(slow.series.stamps) for slow in self.slow), default=0)


class Feed(Protocol):
    """What the slow inputs are given to."""

    def sets_back(self, part: Held) -> bool:
        """Return whether the first of the slow samples of a part moves those before it to a corrected clock."""

    def take(self, part: Held) -> None:
        """Take the slow samples of a part."""


def parts(batch: Batch, slow: list[Slow], last: dict[Need | None, int]) -> Iterator[Held]:
    """Yield a batch in parts of bounded length, cut before each slow sample that steps back in time.

    last: stamp of the last sample of each slow input (ns), moved on.
    """
    steps: set[int] = set()
    edges = {0, len(batch)}
    for one in slow:
        stamps = one.series.stamps
        before = np.concatenate([[last.get(one.need, stamps[0])], stamps[:-1]])
        steps.update(one.rows[stamps <= before - TIME_JUMP].tolist())
        edges.update(one.rows[MOST_SLOW // 2 :: MOST_SLOW // 2].tolist())
        last[one.need] = int(stamps[-1])
    spans = (batch.times - batch.times[0]) // LONGEST
    edges.update((np.flatnonzero(np.diff(spans)) + 1).tolist())
    for start, stop in pairwise(sorted(edges | steps)):
        own = []
        for one in slow:
            rows = slice(*np.searchsorted(one.rows, (start, stop)).tolist())
            if rows.start < rows.stop:
                series = Series(one.series.stamps[rows], one.series.values[rows])
                own.append(Slow(one.need, series, one.rows[rows] - start))
        yield Held(batch.select(slice(start, stop)), tuple(own), start in steps)


def behind(held: Iterable[Held], feed: Feed) -> Iterator[Batch]:
    """Yield the messages of parts, each after ``feed`` has taken what is read ahead of it.

    Where the clock of a slow input is set back, all messages before are handed out first: they belong to the clock
    that was.
    """
    waiting = _Waiting()
    for part in held:
        if part.steps_back and feed.sets_back(part):
            while waiting.parts:
                yield waiting.take()
        feed.take(part)
        waiting.add(part)
        while waiting.enough():
            yield waiting.take()
    while waiting.parts:
        yield waiting.take()


class _Waiting:
    """Parts that are held back, with the sums that bound them."""

    def __init__(self) -> None:
        self.parts: deque[Held] = deque()
        self._size = self._count = 0

    def add(self, part: Held) -> None:
        self.parts.append(part)
        self._size += part.batch.size
        self._count += part.count

    def take(self) -> Batch:
        """Return the messages of the first part, which waits no longer."""
        part = self.parts.popleft()
        self._size -= part.batch.size
        self._count -= part.count
        return part.batch

    def enough(self) -> bool:
        """Return whether enough was read after the first part."""
        return len(self.parts) > 1 and (
            int(self.parts[0].batch.times[-1]) + LOOK_AHEAD < int(self.parts[-1].batch.times[-1])
            or self._size > MOST_HELD
            or self._count > MOST_SLOW
        )
