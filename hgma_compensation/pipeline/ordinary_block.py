"""Blocks of which nothing is to be said but of all samples alike: less the drift of their cells.

The same formula as ``SlowSamples``, for samples that do nothing but go on, without an array that is made anew.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.effect_encoding import LARGEST_ACCELERATION
from hgma_compensation.messages import block_offsets
from hgma_compensation.pipeline.cell_values import Cell
from hgma_compensation.pipeline.screening import SERIAL, increases, sum_of_squares
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]
Rows = NDArray[np.float32]

LARGEST_PART = 0.5 * LARGEST_ACCELERATION
"""A sample is plausible where its drift and what is left of it without are both within this."""

LARGEST_SQUARE = LARGEST_PART * LARGEST_PART


class BlockOffsets:
    """The stamps of a block's samples after its own; the same for all blocks of one length and interval.

    stamps: (n,) ns. last: of the last sample. plain: whether there is a sample, and each is later than the one before.
    """

    def __init__(self, stamps: Stamps) -> None:
        """Take them; not to be written to."""
        self.stamps = stamps
        # A whole number of ns is exact in float64 for 104 days.
        self.numbers = stamps.astype(np.float64)
        self.last = int(stamps[-1]) if len(stamps) else 0
        self.plain = len(stamps) > 0 and increases(stamps)

    def __len__(self) -> int:
        """Return n."""
        return len(self.stamps)


@lru_cache(maxsize=4)
def offsets_of(count: int, interval: float) -> BlockOffsets:
    """Return those of blocks of a length and an interval in s: a sensor sends few kinds, so that these serve all."""
    return BlockOffsets(block_offsets(count, interval))


@dataclass(frozen=True)
class BlockSums:
    """Of samples less their drift: sums and sums of squares (k,), and the last sample (k,).

    statuses: how many samples have each TemperatureStatus but OK.
    """

    count: int
    statuses: Counter[int]
    totals: list[float]
    squares: list[float]
    last: list[float]


class OrdinaryBlocks:
    """Takes blocks one after the other, in memory that serves all of them."""

    def __init__(self) -> None:
        """Take the memory with the first block."""
        self._room = np.empty((0, 0, 0))
        self._way = np.empty(0)

    def take(self, stamp: int, offsets: BlockOffsets, rows: Rows, cells: Sequence[Cell], out: Rows) -> BlockSums | None:
        """Write the samples (k, n) of a block at a stamp (ns) less their drift to ``out`` (k, n).

        out: may be the rows themselves. cells: those from the first sample to the last. Return what the samples add up
        to; None where one may be implausible, and ``out`` is then to be thrown away.
        """
        count, begin = len(offsets), 0
        totals, squares = [0.0] * len(rows), [0.0] * len(rows)
        statuses: Counter[int] = Counter()
        left: Array = np.empty((len(rows), 0))
        for cell in cells:
            end = count if stamp + offsets.last < cell.until else int(offsets.stamps.searchsorted(cell.until - stamp))
            if cell.status:
                statuses[cell.status] += end - begin
            while begin < end:
                piece = slice(begin, min(begin + SERIAL, end))
                left = self._less_drift(stamp, offsets.numbers[piece], rows[:, piece], cell)
                found = list(map(sum_of_squares, left))
                # The comparisons are false for NaN too.
                if not (cell.largest_drift <= LARGEST_PART and all(one <= LARGEST_SQUARE for one in found)):
                    return None
                out[:, piece] = left
                totals = [a + b for a, b in zip(totals, left.sum(axis=1).tolist(), strict=True)]
                squares = [a + b for a, b in zip(squares, found, strict=True)]
                begin = piece.stop
        return BlockSums(count, statuses, totals, squares, left[:, -1].tolist())

    def _less_drift(self, stamp: int, offsets: Array, rows: Rows, cell: Cell) -> Array:
        """Return the samples (k, n) of a piece in one cell less their drift; gone with the next piece."""
        shape = (2, *rows.shape)
        if self._room.shape != shape:
            self._room, self._way = np.empty(shape), np.empty(len(offsets))
        way, (drift, left) = self._way, self._room
        # The sum is a whole number below 2^53, as exact as the difference of the stamps themselves.
        np.add(offsets, stamp - cell.begin, out=way)
        np.multiply(way, cell.inverse, out=way)
        np.multiply(way, cell.change, out=drift)
        np.add(drift, cell.first, out=drift)
        left[...] = rows
        return np.subtract(left, drift, out=left)
