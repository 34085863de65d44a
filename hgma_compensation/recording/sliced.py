"""Samples that are read in parts, be they in memory or in a file."""

from collections.abc import Iterator, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.recording.recording import Series
from hgma_compensation.recording.source import Source


class Sliced(Protocol):
    """What an array and rows in a file have in common."""

    def __len__(self) -> int:
        """Return the number of rows."""

    def __getitem__(self, rows: slice, /) -> NDArray[Any]:
        """Return the rows of a slice."""


class Column:
    """One column (n,) of rows (n, width)."""

    def __init__(self, rows: Sliced, number: int) -> None:
        """Take the column of that number."""
        self._rows, self._number = rows, number

    def __len__(self) -> int:
        """Return n."""
        return len(self._rows)

    def __getitem__(self, rows: slice, /) -> NDArray[Any]:
        """Return the rows (k,) of a slice."""
        return np.ascontiguousarray(self._rows[rows][:, self._number])


class Joined:
    """Rows one after the other."""

    def __init__(self, parts: Sequence[Sliced]) -> None:
        """Take the parts in their order; there must be one."""
        self._parts = tuple(parts)
        self._ends = np.cumsum([len(part) for part in parts]).tolist()

    def __len__(self) -> int:
        """Return the number of rows of all parts."""
        return int(self._ends[-1])

    def __getitem__(self, rows: slice, /) -> NDArray[Any]:
        """Return the rows of a slice."""
        start, stop, _ = rows.indices(len(self))
        starts = [0, *self._ends[:-1]]
        parts = [
            part[max(start - first, 0) : max(stop - first, 0)]
            for part, first, last in zip(self._parts, starts, self._ends, strict=True)
            if start < last and stop > first
        ]
        return np.concatenate(parts) if parts else self._parts[0][:0]


def one_after_the_other(parts: Sequence[Sliced]) -> Sliced:
    """Return parts in their order: an array where all of them are arrays."""
    if all(isinstance(part, np.ndarray) for part in parts):
        return np.concatenate(parts)  # type: ignore[arg-type]
    return Joined(parts)


def in_parts(count: int, size: int) -> Iterator[slice]:
    """Yield slices of at most ``size`` rows of ``count``."""
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))


class Sampled(Source, Protocol):
    """A recording whose samples are read in parts; the attributes are those of Recording."""

    @property
    def stamps(self) -> Sliced:
        """(n,) ns of the accelerometer."""

    @property
    def values(self) -> Sliced:
        """(n, 6), columns CHANNELS, m/s² and rad/s."""

    @property
    def block(self) -> Sliced | None:
        """(n,) number of the AccelBlock that each sample came in, None where each came in a message of its own."""

    @property
    def temperature_2(self) -> Series:
        """The second thermometer, °C."""

    @property
    def supply_voltage(self) -> Series:
        """The supply voltage, V."""

    @property
    def first(self) -> int:
        """Least stamp of the accelerometer, ns."""

    @property
    def last(self) -> int:
        """Greatest stamp of the accelerometer, ns."""

    def has(self, name: str) -> bool:
        """Return whether there is a finite sample of a slow input, named as its field is."""
