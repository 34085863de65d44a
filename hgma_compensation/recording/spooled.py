"""Rows of numbers that wait in a temporary file until all have come."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import SEEK_END
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from hgma_compensation.errors import RefusedError

AT_ONCE = 1 << 13
"""Rows that are read at once."""


class Spooled:
    """Rows of ``width`` numbers in a file that has no name and goes with the process, however that ends."""

    def __init__(self, width: int, dtype: DTypeLike = np.float64) -> None:
        """Start without rows."""
        self._width, self._dtype = width, np.dtype(dtype)
        with _told():
            self._file = tempfile.TemporaryFile()  # noqa: SIM115  closed with the object
        self._rows = 0

    def __len__(self) -> int:
        """Return the number of rows."""
        return self._rows

    def add(self, rows: NDArray[Any]) -> None:
        """Take rows (n, width); raises RefusedError where the disk is full."""
        with _told():
            self._file.seek(0, SEEK_END)
            self._file.write(np.ascontiguousarray(rows, dtype=self._dtype).data)
        self._rows += len(rows)

    def __getitem__(self, rows: slice, /) -> NDArray[Any]:
        """Return rows (k, width) from a start to before a stop, as a slice of an array gives them."""
        start, stop, step = rows.indices(self._rows)
        if step != 1:
            raise ValueError(f"rows in a file are read one after the other, not every {step}th")
        size, count = self._width * self._dtype.itemsize, max(stop - start, 0)
        with _told():
            self._file.seek(start * size)
            content = self._file.read(count * size)
        return np.frombuffer(content, dtype=self._dtype).reshape(-1, self._width)

    def parts(self, most: int | None = None) -> Iterator[NDArray[Any]]:
        """Yield the first ``most`` rows (k, width), or all, in their order."""
        rows = self._count(most)
        for start in range(0, rows, AT_ONCE):
            yield self[start : min(start + AT_ONCE, rows)]

    def _count(self, most: int | None) -> int:
        return self._rows if most is None else min(most, self._rows)

    def column(self, number: int, most: int | None = None) -> NDArray[Any]:
        """Return one column (n,) of the first ``most`` rows, or of all."""
        column, done = np.empty(self._count(most), dtype=self._dtype), 0
        for part in self.parts(most):
            column[done : done + len(part)] = part[:, number]
            done += len(part)
        return column


@contextmanager
def _told() -> Iterator[None]:
    """Say, of what the system refuses, where it was and what to do."""
    try:
        yield
    except OSError as error:
        raise RefusedError(
            f"the folder of temporary files cannot hold one ({error.strerror}): "
            "free some space, or set TMPDIR to another folder"
        ) from None
