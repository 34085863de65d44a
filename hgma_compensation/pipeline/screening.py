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


def usable_samples(stamps: Stamps, values: Array) -> NDArray[np.bool_]:
    """Return (n,) whether samples have a stamp, and values (n, c) that a sensor can have sent."""
    # The comparison is false for NaN too.
    return np.asarray((stamps > 0) & (np.abs(values) <= LARGEST_ACCELERATION).all(axis=1))


def _all_usable(stamps: Stamps, values: Array) -> bool:
    """Return whether all samples are usable, column by column: the fastest way for a block."""
    # A NaN is the extreme of its column, and the comparison is false for it.
    return bool(stamps.min() > 0) and all(
        column.max() <= LARGEST_ACCELERATION and column.min() >= -LARGEST_ACCELERATION for column in values.T
    )


def reason_to_skip(stamps: Stamps, values: Array) -> Skip | None:
    """Return why samples that belong together (n,) with values (n, c) get no output, None where they do."""
    if not len(stamps) or (_all_usable(stamps, values) if len(stamps) > FEW else usable_samples(stamps, values).all()):
        return None
    if not (stamps > 0).all():
        return Skip.NOT_STAMPED
    return Skip.IMPLAUSIBLE if np.isfinite(values).all() else Skip.NOT_FINITE


def out_of_step(stamps: Stamps, newest: int | None) -> dict[Note, int]:
    """Return how many samples repeat a stamp, or come late, after those up to ``newest`` (ns)."""
    if len(stamps) == 1:
        return _single(int(stamps[0]), newest)
    if newest is not None and stamps[0] > newest and (stamps[1:] > stamps[:-1]).all():
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
