"""Arrays that grow with what is read, whatever a file says of its length."""

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

FIRST = 1 << 20
"""Rows before the first growth; a count that a file declares is believed up to here."""


class Growing:
    """An array (n, ...) that is filled from its beginning; growing moves pages of memory, copying none.

    declared: rows that are expected. shape: of one row.
    """

    def __init__(self, declared: int, dtype: DTypeLike, shape: tuple[int, ...] = ()) -> None:
        """Begin without rows."""
        self._declared = declared
        self._array = np.empty((min(max(declared, 1), FIRST), *shape), dtype=dtype)
        self._rows = 0

    def __len__(self) -> int:
        """Return the number of rows."""
        return self._rows

    def extend(self, rows: NDArray[Any]) -> None:
        """Add rows (k, ...)."""
        end = self._rows + len(rows)
        length = len(self._array)
        while length < end:
            doubled = 2 * length
            length = min(doubled, self._declared) if length < self._declared else doubled
        if length > len(self._array):
            # Nobody else has seen the array yet, so that it may move.
            self._array.resize((length, *self._array.shape[1:]), refcheck=False)
        self._array[self._rows : end] = rows
        self._rows = end

    def array(self) -> NDArray[Any]:
        """Return the rows; nothing may be added afterwards."""
        self._array.resize((self._rows, *self._array.shape[1:]), refcheck=False)
        return self._array
