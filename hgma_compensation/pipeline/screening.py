"""Which samples of the accelerometer are let into the pipeline, in the node and offline alike."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.effect_encoding import LARGEST_ACCELERATION
from hgma_compensation.pipeline.reasons import Note, Skip
from hgma_compensation.stamps import Stamps
from hgma_compensation.time_jumps import TIME_JUMP

Array = NDArray[np.float64]


FEW = 64
"""Samples up to which one operation on all of them is faster than one for each column."""

SERIAL = 10_000
"""Numbers up to which BLAS adds products up in one thread; as many of three channels lie in a cache, too."""

LARGEST_SQUARE = LARGEST_ACCELERATION * LARGEST_ACCELERATION


def usable_samples(stamps: Stamps, values: Array) -> NDArray[np.bool_]:
    """Return (n,) whether samples have a stamp, and values (n, c) that a sensor can have sent."""
    # The comparison is false for NaN too.
    return np.asarray((stamps > 0) & (np.abs(values) <= LARGEST_ACCELERATION).all(axis=1))


def sum_of_squares(column: Array) -> float:
    """Return Σ x² of a column (n,)."""
    if len(column) <= SERIAL:
        return float(np.dot(column, column))
    pieces = (column[row : row + SERIAL] for row in range(0, len(column), SERIAL))
    return sum(float(np.dot(piece, piece)) for piece in pieces)


def all_usable(stamps: Stamps, values: Array) -> bool:
    """Return whether all of n > 0 samples are usable, as ``usable_samples`` says of each."""
    if len(stamps) == 1:
        return bool(stamps[0] > 0) and all(abs(value) <= LARGEST_ACCELERATION for value in values[0].tolist())
    if len(stamps) <= FEW:
        return bool(usable_samples(stamps, values).all())
    # No square is larger than the sum of all, which costs a fraction of a look at each value.
    quiet = bool(stamps.min() > 0) and all(sum_of_squares(column) <= LARGEST_SQUARE for column in values.T)
    return quiet or bool(usable_samples(stamps, values).all())


def reason_to_skip(stamps: Stamps, values: Array) -> Skip | None:
    """Return why samples that belong together (n,) with values (n, c) get no output, None where they do."""
    if not len(stamps) or all_usable(stamps, values):
        return None
    if not (stamps > 0).all():
        return Skip.NOT_STAMPED
    return Skip.IMPLAUSIBLE if np.isfinite(values).all() else Skip.NOT_FINITE


def increases(stamps: Stamps) -> bool:
    """Return whether each stamp (n > 0,) is later than the one before it."""
    return len(stamps) == 1 or bool((stamps[1:] > stamps[:-1]).all())


def out_of_step(stamps: Stamps, newest: int | None, *, ordered: bool = False) -> dict[Note, int]:
    """Return how many samples repeat a stamp, or come late, after those up to ``newest`` (ns).

    ordered: whether the stamps are known to increase.
    """
    if len(stamps) == 1:
        return _single(int(stamps[0]), newest)
    if ordered and newest is not None and stamps[0] > newest:
        return {}
    before = np.maximum.accumulate(stamps)[:-1]
    before = np.concatenate([stamps[:1] - 1 if newest is None else [newest], before])
    behind = before - stamps
    repeated, late = np.count_nonzero(behind == 0), np.count_nonzero((behind > 0) & (behind <= TIME_JUMP))
    found = {Note.STAMP_REPEATED: int(repeated), Note.OUT_OF_ORDER: int(late)}
    return {note: count for note, count in found.items() if count}


def _single(stamp: int, newest: int | None) -> dict[Note, int]:
    if newest is None or not 0 <= newest - stamp <= TIME_JUMP:
        return {}
    return {Note.STAMP_REPEATED if stamp == newest else Note.OUT_OF_ORDER: 1}
