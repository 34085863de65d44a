"""What holds in cells: the lines that the drift is, and what is said of the temperature."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.pipeline.cells import Cells
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Line:
    """Straight lines over m cells: value at the beginning of each and change until its end, (m, k)."""

    first: Array
    change: Array

    def part(self, cells: slice | list[int]) -> "Line":
        """Return the lines of some of the cells."""
        return Line(self.first[cells], self.change[cells])

    @classmethod
    def through(cls, ends: Array) -> "Line":
        """Return the lines through values (2m, k): those at all beginnings, then those at all ends."""
        first, last = np.split(ends, 2)
        return cls(first, last - first)

    @classmethod
    def joined(cls, lines: Sequence["Line"]) -> "Line":
        """Return the lines of several lots of cells, one after the other."""
        return cls(np.concatenate([line.first for line in lines]), np.concatenate([line.change for line in lines]))


@dataclass(frozen=True)
class CellValues:
    """What holds in m cells.

    inverse: (m,) 1/ns, one over the length. features: before clamping, the middle of the calibrated range where the
    temperature is missing; k = 3. model, effects: k = c, drift of the model and that of the slow effects, if there are
    any. drift: both together; k = c. status,
    inside: (m,) at the beginning. mixed: (m,) whether status or range are others at the end, so that each sample must
    be looked at. age, since_power_on: (m,) s at the beginning. unusable, missing: (m,), the same all through a cell.
    """

    begin: Stamps
    inverse: Array
    features: Line
    model: Line
    effects: Line | None
    drift: Line
    status: NDArray[np.uint8]
    inside: NDArray[np.bool_]
    mixed: NDArray[np.bool_]
    age: Array
    since_power_on: Array
    unusable: NDArray[np.bool_]
    missing: NDArray[np.bool_]

    def part(self, cells: slice | list[int]) -> "CellValues":
        """Return what holds in some of the cells."""
        return CellValues(**{name: _part(getattr(self, name), cells) for name in self.__dataclass_fields__})

    @classmethod
    def joined(cls, parts: Sequence["CellValues"]) -> "CellValues":
        """Return what holds in several lots of cells of one calibration, one after the other."""
        if len(parts) == 1:
            return parts[0]
        return cls(**{name: _joined([getattr(part, name) for part in parts]) for name in cls.__dataclass_fields__})

    @cached_property
    def ordinary(self) -> bool:
        """Whether the temperature is what the calibration knows, in all cells and all through them."""
        return not (self.status.any() or self.mixed.any())


def _part(field: Any, cells: slice | list[int]) -> Any:
    if field is None:
        return None
    return field.part(cells) if isinstance(field, Line) else field[cells]


def _joined(fields: list[Any]) -> Any:
    if fields[0] is None:
        return None
    return Line.joined(fields) if isinstance(fields[0], Line) else np.concatenate(fields)


@dataclass(frozen=True)
class Cell:
    """One cell and its line in the form in which many samples are taken through it.

    lot, index: the cells that it is one of, and which. begin, until: ns. inverse: 1/ns. first, change: (c, 1).
    largest_drift: of any channel, without sign. status, inside: at the beginning. uniform: whether they are the same
    for all samples.
    """

    lot: CellValues
    index: int
    begin: int
    until: int
    inverse: float
    first: Array
    change: Array
    largest_drift: float
    status: int
    inside: bool
    uniform: bool

    @classmethod
    def of(cls, lot: CellValues, index: int, until: int) -> "Cell":
        """Return one of some cells, which gives way to the next at a stamp, ns."""
        first, change = lot.drift.first[index, :, None], lot.drift.change[index, :, None]
        largest = float(np.maximum(np.abs(first), np.abs(first + change)).max())
        begin, inverse = int(lot.begin[index]), float(lot.inverse[index])
        status, inside, uniform = int(lot.status[index]), bool(lot.inside[index]), not lot.mixed[index]
        return cls(lot, index, begin, until, inverse, first, change, largest, status, inside, uniform)

    @cached_property
    def values(self) -> CellValues:
        """What holds in it (m = 1)."""
        return self.lot.part(slice(self.index, self.index + 1))


def values_of(cells: Sequence[Cell]) -> CellValues:
    """Return what holds in each of some cells (m > 0,) of one calibration."""
    parts = []
    for _, some in groupby(cells, lambda cell: id(cell.lot)):
        same = list(some)
        parts.append(same[0].lot.part([cell.index for cell in same]))
    return CellValues.joined(parts)


class KnownCells:
    """Cells that follow one another, of which a stream is in one after the other."""

    def __init__(self, begin: Sequence[int] = (), until: Sequence[int] = (), values: CellValues | None = None) -> None:
        """Take their beginnings and ends (m,), ns, and what holds in them; none to begin with."""
        self._begin, self._until, self._values = begin, until, values
        self._cells: dict[int, Cell] = {}
        self._last: Cell | None = None

    @classmethod
    def of(cls, cells: Cells, values: CellValues) -> "KnownCells":
        """Return cells and what holds in them."""
        return cls(cells.begin.tolist(), cells.until.tolist(), values)

    def at(self, stamp: int) -> Cell | None:
        """Return the cell of a stamp (ns), None where it is none of these."""
        last = self._last
        if last is not None and last.begin <= stamp < last.until:
            return last
        index = bisect_right(self._begin, stamp) - 1
        if index < 0 or stamp >= self._until[index]:
            return None
        assert self._values is not None
        if index not in self._cells:
            self._cells[index] = Cell.of(self._values, index, self._until[index])
        self._last = self._cells[index]
        return self._last
