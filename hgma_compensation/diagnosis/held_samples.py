"""Samples of the hold-out, in files, and the shorter series that their Allan deviation is drawn from."""

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.medians import median_of
from hgma_compensation.recording.spooled import Spooled
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]


class HeldSamples:
    """Samples of one channel in their order, NaN where there is no value."""

    def __init__(self, parts: Iterable[tuple[Stamps, Array]]) -> None:
        """Take stamps (n,) in ns and values (n,), part by part."""
        self._steps, self._values = Spooled(1, np.int64), Spooled(1)
        self._known = 0
        last: Stamps = np.empty(0, dtype=np.int64)
        for stamps, values in parts:
            self._steps.add(np.diff(stamps, prepend=last)[:, None])
            self._values.add(values[:, None])
            self._known += int(np.isfinite(values).sum())
            last = stamps[-1:] if len(stamps) else last

    def __len__(self) -> int:
        """Return n."""
        return len(self._values)

    @property
    def known(self) -> float:
        """Share of the samples that have a value."""
        return self._known / max(len(self), 1)

    @property
    def interval(self) -> float:
        """Median time from one sample to the next, s; 0 for fewer than two."""
        if not len(self._steps):
            return 0.0
        return median_of(lambda: (steps[:, 0] for steps in self._steps.parts())) * 1e-9

    def values(self) -> Array:
        """Return the samples (n,), all of them in memory."""
        return self._values.column(0)

    def means(self, most: int) -> tuple[int, Array]:
        """Return how many samples are averaged for each of at most ``most`` means, and these means (m,).

        What has no value is interpolated; some must have one.
        """
        size = -(-len(self) // most)
        means, left = [np.empty(0)], np.empty(0)
        for part in self._filled():
            left = np.concatenate([left, part])
            whole = len(left) // size * size
            means.append(left[:whole].reshape(-1, size).mean(axis=1))
            left = left[whole:]
        return size, np.concatenate(means)

    def _filled(self) -> Iterator[Array]:
        """Yield the samples with those that have no value between their neighbours that do, or like the only one."""
        before: tuple[Array, Array] = np.empty(0), np.empty(0)
        waiting: list[Array] = []  # the newest sample that has a value, and all after it
        begin = done = 0
        for part in self._values.parts():
            waiting.append(part[:, 0])
            known = done + np.flatnonzero(np.isfinite(part[:, 0]))
            done += len(part)
            if len(known):
                yield _interpolated(np.concatenate(waiting), begin, before, end=int(known[-1]) + 1)
                before = known[-1:].astype(np.float64), part[known[-1:] - (done - len(part)), 0]
                waiting, begin = [part[known[-1] + 1 - (done - len(part)) :, 0]], int(known[-1]) + 1
        yield _interpolated(np.concatenate([np.empty(0), *waiting]), begin, before, end=done)


def _interpolated(values: Array, begin: int, before: tuple[Array, Array], *, end: int) -> Array:
    """Return the samples from ``begin`` to before ``end``; values: from ``begin`` on; before: the last known one."""
    values = values[: end - begin]
    index = np.arange(begin, end)
    known = np.isfinite(values)
    at, there = np.concatenate([before[0], index[known]]), np.concatenate([before[1], values[known]])
    return np.interp(index, at, there) if len(index) else np.empty(0)
