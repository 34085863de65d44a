"""Serialised messages of a bag, many at a time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from hgma_compensation.cdr.rows import unstacked
from hgma_compensation.stamps import Stamps

Indices = NDArray[np.int64]


class Batch:
    """Messages in the order in which a bag hands them out.

    topics: (n,) which of the connections asked for each is of. times: (n,) log times, ns. sizes: (n,) bytes of each.
    apart: the messages where they lie apart; they are brought together when ``memory`` is asked for, which blocks of
    samples are never.
    """

    def __init__(
        self, topics: Indices, times: Stamps, memory: NDArray[np.uint8], starts: Indices, sizes: Indices
    ) -> None:
        """Take messages that lie at starts (n,) in memory (m,)."""
        self.topics, self.times, self.sizes = topics, times, sizes
        self.apart: list[bytes] | None = None
        self._memory, self._starts = memory, starts

    @classmethod
    def of_messages(cls, topics: Sequence[int], times: Sequence[int], raws: list[bytes]) -> Batch:
        """Return messages that lie apart as a batch."""
        sizes = np.fromiter(map(len, raws), dtype=np.int64, count=len(raws))
        return cls._apart(np.array(topics, dtype=np.int64), np.array(times, dtype=np.int64), sizes, raws)

    @classmethod
    def _apart(cls, topics: Indices, times: Stamps, sizes: Indices, raws: list[bytes]) -> Batch:
        batch = cls(topics, times, np.empty(0, dtype=np.uint8), np.cumsum(sizes) - sizes, sizes)
        batch.apart = raws
        return batch

    @cached_property
    def memory(self) -> NDArray[np.uint8]:
        """Return the bytes (m,) that the messages lie in."""
        return self._memory if self.apart is None else np.frombuffer(b"".join(self.apart), dtype=np.uint8)

    @property
    def starts(self) -> Indices:
        """Return the place (n,) of each message in the memory."""
        return self._starts

    @cached_property
    def size(self) -> int:
        """Return the bytes of all messages."""
        return int(self.sizes.sum())

    def __len__(self) -> int:
        """Return n."""
        return len(self.times)

    def select(self, rows: Indices | slice) -> Batch:
        """Return some of the messages, without a copy."""
        topics, times, sizes = self.topics[rows], self.times[rows], self.sizes[rows]
        if self.apart is None:
            return Batch(topics, times, self.memory, self.starts[rows], sizes)
        apart = self.apart[rows] if isinstance(rows, slice) else [self.apart[row] for row in rows.tolist()]
        return self._apart(topics, times, sizes, apart)

    def compact(self) -> Batch:
        """Return the messages on memory that holds little else, so that what they were read from can go."""
        if not len(self):
            return Batch(self.topics, self.times, self.memory[:0], self.starts, self.sizes)
        first, last = int(self.starts.min()), int((self.starts + self.sizes).max())
        if last - first <= 2 * self.size + 4096:
            return Batch(self.topics, self.times, self.memory[first:last].copy(), self.starts - first, self.sizes)
        return Batch.of_messages(self.topics.tolist(), self.times.tolist(), self.raws())

    def raws(self) -> list[bytes]:
        """Return the messages one by one."""
        if self.apart is not None:
            return self.apart
        size = int(self.sizes[0]) if len(self) else 0
        if size and (self.sizes == size).all() and (np.diff(self.starts) == size).all():
            first = int(self.starts[0])
            return unstacked(self.memory[first : first + len(self) * size].reshape(len(self), size))
        memory = self.memory.data
        return [bytes(memory[a : a + n]) for a, n in zip(self.starts.tolist(), self.sizes.tolist(), strict=True)]

    def raw(self, row: int) -> memoryview:
        """Return one message, without a copy."""
        if self.apart is not None:
            return memoryview(self.apart[row])
        start = int(self.starts[row])
        return self.memory[start : start + int(self.sizes[row])].data

    def rows(self) -> NDArray[np.uint8]:
        """Return messages that all have the same size, and one at least, as rows (n, size)."""
        return windows(self.memory, int(self.sizes[0]))[self.starts]

    def same_sizes(self) -> Iterator[Indices]:
        """Yield the rows of consecutive messages of the same size."""
        if len(self):
            edges = np.flatnonzero(np.diff(self.sizes)) + 1
            yield from np.split(np.arange(len(self), dtype=np.int64), edges)


def windows(memory: NDArray[np.uint8], size: int, *, writeable: bool = False) -> NDArray[np.uint8]:
    """Return all places of memory (m,) at which that many bytes can lie, (m - size + 1, size)."""
    return sliding_window_view(memory, size, writeable=writeable)


def joined(batches: Sequence[Batch]) -> Batch:
    """Return batches as one."""
    if len(batches) == 1:
        return batches[0]
    offsets = np.cumsum([0, *(len(batch.memory) for batch in batches[:-1])])
    return Batch(
        np.concatenate([batch.topics for batch in batches]),
        np.concatenate([batch.times for batch in batches]),
        np.concatenate([batch.memory for batch in batches]),
        np.concatenate([batch.starts + offset for batch, offset in zip(batches, offsets.tolist(), strict=True)]),
        np.concatenate([batch.sizes for batch in batches]),
    )


def gathered(batches: Iterable[Batch], size: int) -> Iterator[Batch]:
    """Yield the messages of batches in batches of at least so many bytes, but for the last."""
    waiting: list[Batch] = []
    held = 0
    for batch in batches:
        waiting.append(batch)
        held += len(batch.memory)
        if held >= size:
            yield joined(waiting)
            waiting, held = [], 0
    if waiting:
        yield joined(waiting)
