"""Messages of equal length as the rows of one array, and back."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

FLOAT64 = np.dtype("<f8")
INT32 = np.dtype("<i4")
UINT32 = np.dtype("<u4")


def stacked(raws: Sequence[bytes]) -> NDArray[np.uint8]:
    """Return messages of equal length as rows (n, size), read-only.

    Raises ValueError where there is none, or their lengths differ.
    """
    if len(set(map(len, raws))) != 1:
        raise ValueError("only messages of equal length, and at least one, are the rows of an array")
    # A single message is its own row, without a copy.
    memory = raws[0] if len(raws) == 1 else b"".join(raws)
    return np.frombuffer(memory, dtype=np.uint8).reshape(len(raws), len(raws[0]))


def unstacked(rows: NDArray[np.uint8]) -> list[bytes]:
    """Return the rows (n, size) as messages."""
    # The items of a void array are bytes objects, made three times as fast as by slicing.
    raws: list[bytes] = np.ascontiguousarray(rows).view(f"V{rows.shape[1]}").ravel().tolist()
    return raws


def fields(rows: NDArray[np.uint8], start: int, stop: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return the bytes [start, stop) of every row (n, size) as numbers (n, count), on the memory of the rows."""
    return rows[:, start:stop].view(dtype)
