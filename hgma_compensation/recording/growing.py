"""Arrays that grow with what is read, whatever a file says of its length."""

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

FIRST = 1 << 20
"""Rows before the first growth; a count that a file declares is believed up to here."""


class Growing:
    """An array (n, ...) that is filled row by row; growing moves pages of memory and copies nothing where it is large.

    declared: rows that are expected. shape: of one row.
    """

    def __init__(self, declared: int, dtype: DTypeLike, shape: tuple[int, ...] = ()) -> None:
        """Begin without rows."""
        self._declared = declared
        self._array = np.empty((min(max(declared, 1), FIRST), *shape), dtype=dtype)
        self._rows = 0

    def append(self, row: Any) -> None:
        """Add a row."""
        if self._rows == len(self._array):
            length = 2 * len(self._array)
            if len(self._array) < self._declared:
                length = min(length, self._declared)
            # Nobody else has seen the array yet, so that it may move.
            self._array.resize((length, *self._array.shape[1:]), refcheck=False)
        self._array[self._rows] = row
        self._rows += 1

    def array(self) -> NDArray[Any]:
        """Return the rows; nothing may be added afterwards."""
        self._array.resize((self._rows, *self._array.shape[1:]), refcheck=False)
        return self._array
