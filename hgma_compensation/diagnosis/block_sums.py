"""Means over blocks of samples that come in parts."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class BlockSums:
    """Running sums of k columns at the edges of blocks, which are half open; the parts change no bit of them.

    The sum goes on from the first sample to the last: a block's is the difference of two of them.
    """

    def __init__(self, first: NDArray[np.int64], last: NDArray[np.int64], width: int) -> None:
        """Take the blocks' first samples and those after their last (n,)."""
        self._edges = np.stack([first, last])
        self._sums = np.zeros((2, len(first), width))
        self._total, self._done = np.zeros((1, width)), 0

    def add(self, samples: Array) -> None:
        """Take samples (m, k), which go on from those before."""
        running = np.cumsum(np.concatenate([self._total, samples]), axis=0)
        inside = (self._edges >= self._done) & (self._edges <= self._done + len(samples))
        self._sums[inside] = running[self._edges[inside] - self._done]
        self._total, self._done = running[-1:].copy(), self._done + len(samples)

    def means(self) -> Array:
        """Return the means (n, k) once all samples have come."""
        (first, last), (at_first, at_last) = self._edges, self._sums
        return np.asarray((at_last - at_first) / (last - first)[:, None])
