"""Cells of time in which a drift that is slow is a straight line, predicted at the beginning of the cell.

A cell begins where readings, be it of now or of a delay ago, go on to another sample of a slow input, and at each
multiple of STEP; it ends at the next multiple. What it holds is decided by stamps alone, so that a stream and a batch
have the same cells.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.pipeline.inputs import Inputs
from hgma_compensation.stamps import Stamps

STEP = 500_000_000
"""Longest cell, ns: the temperature moves by less than a tenth of a degree in it."""


MOST, FARTHEST = 64, 10 * STEP
"""Cells that are evaluated before there is a sample in them, and how far ahead (ns) they end.

A stream knows of few: its slow inputs are hardly ahead of it. A recording is read ahead by many.
"""


@dataclass(frozen=True)
class Cells:
    """begin, end: (m,) ns, between which a cell's line is drawn. until: (m,) ns, where the next cell takes over."""

    begin: Stamps
    end: Stamps
    until: Stamps


@dataclass(frozen=True)
class Places:
    """In which of m cells each of n samples lies: index (n,) of cells, or None where all lie in the only one.

    counts: (m,) samples of each cell where they come in the order of the cells, None where they do not.
    """

    index: NDArray[np.int64] | None
    counts: NDArray[np.int64] | None

    def take(self, rows: NDArray[np.int64]) -> "Places":
        """Return the places of some of the samples (k,)."""
        return Places(None if self.index is None else self.index[rows], None)


ALONE = Places(None, None)
"""All in one cell."""


def cells_of(inputs: Inputs, stamps: Stamps) -> tuple[Cells, Places]:
    """Return the cells that hold the samples (n > 0,) at stamps in ns, and the place of each sample."""
    low, high = int(stamps.min()), int(stamps.max())
    grid = np.arange(low // STEP, high // STEP + 2) * STEP
    changes = inputs.changes(int(grid[0]), int(grid[-1]))
    begin = _union(grid[:-1], changes) if len(changes) else grid[:-1]
    index = begin.searchsorted(stamps, side="right") - 1
    if len(stamps) == 1 or low >= begin[index_high := int(begin.searchsorted(high, side="right")) - 1]:
        at = slice(int(index[0]), int(index[0]) + 1)
        return _cells(begin, grid, at), ALONE
    counts = np.bincount(index, minlength=index_high + 1)
    held = np.flatnonzero(counts)
    new = np.zeros(len(counts), dtype=np.int64)
    new[held] = np.arange(len(held))
    in_order = bool((index[1:] >= index[:-1]).all())
    return _cells(begin, grid, held), Places(new[index], counts[held] if in_order else None)


def cells_from(inputs: Inputs, stamp: int, until: int) -> Cells:
    """Return the cell of a stamp (ns) and those after it that end by ``until``, at most MOST of them."""
    grid = np.arange(stamp // STEP, max(min(until, stamp + FARTHEST), stamp) // STEP + 2) * STEP
    begin = _union(grid[:-1], inputs.changes(int(grid[0]), int(grid[-1])))
    first = int(begin.searchsorted(stamp, side="right")) - 1
    ended = int(begin.searchsorted(until, side="right")) - 1
    return _cells(begin, grid, slice(first, max(min(ended, first + MOST), first + 1)))


def _union(first: Stamps, second: Stamps) -> Stamps:
    """Return what np.union1d does, which would load numpy.ma: as long as several samples at the start of a node."""
    both = np.sort(np.concatenate((first, second)))
    return both[np.append(True, both[1:] != both[:-1])]


def _cells(begin: Stamps, grid: Stamps, held: NDArray[np.int64] | slice) -> Cells:
    until = np.append(begin[1:], grid[-1])[held]
    begin = begin[held]
    return Cells(begin, (begin // STEP + 1) * STEP, until)
