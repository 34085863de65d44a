"""The median of numbers that come in parts, exact, in memory that does not depend on how many there are."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[Any]
"""(n,) int64, or float64 that are not negative: of these the bits are ordered as the numbers are."""

BITS = 16
"""Of a number that are looked at in one pass."""

SIGN = np.int64(np.iinfo(np.int64).min)


def median_of(parts: Callable[[], Iterator[Numbers]]) -> float:
    """Return the median of numbers, as np.median does, NaN where one of them is; parts: begins to yield them anew.

    A radix selection: each pass counts the numbers that begin with the bits found so far, by the bits that follow.
    """
    count, kind = 0, np.dtype(np.float64)
    for part in parts():
        if np.issubdtype(part.dtype, np.floating) and np.isnan(part).any():
            return float("nan")
        count, kind = count + len(part), part.dtype
    if not count:
        return float("nan")
    middle = [_of_rank(parts, rank) for rank in sorted({(count - 1) // 2, count // 2})]
    return float(np.mean(np.array(middle, dtype=np.int64).view(kind)))


def _of_rank(parts: Callable[[], Iterator[Numbers]], rank: int) -> int:
    """Return the bits of the number with so many before it, in increasing order."""
    found = 0
    for shift in range(64 - BITS, -1, -BITS):
        counts = np.zeros(1 << BITS, dtype=np.int64)
        for part in parts():
            bits = (np.ascontiguousarray(part).view(np.int64) ^ SIGN).view(np.uint64)
            if shift < 64 - BITS:
                bits = bits[bits >> np.uint64(shift + BITS) == found]
            counts += np.bincount((bits >> np.uint64(shift)).astype(np.int64) & ((1 << BITS) - 1), minlength=1 << BITS)
        before = np.cumsum(counts)
        digit = int(np.searchsorted(before, rank, side="right"))
        rank -= int(before[digit] - counts[digit])
        found = (found << BITS) | digit
    return int(np.uint64(found).astype(np.int64) ^ SIGN)
