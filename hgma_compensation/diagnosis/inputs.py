"""Real acceleration in a recording: what must not be taken for drift, and what input-driven effects need.

A centrifuge or a tumble holds a level for a while, again and again, and its true value is not in the bag. Levels that
recur are therefore fitted beside the drift model, one number for +A and −A together; blocks of motion that does not
recur are left out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.blocks import Blocks

Array = NDArray[np.float64]

JUMP = 100.0
"""Deviations of a block's white noise: a step of the level beyond this is motion, unless it stays."""

SHARP = 20.0
"""The same over what the level usually changes by from block to block: drift is no step, however quiet the sensor."""

USUAL = 0.75
"""Quantile of these changes that counts as usual: the steps themselves may be more than a tenth of them."""

ALIKE = 1.12
"""Ratio of magnitudes up to which two levels are the same one."""

FEWEST_VISITS = 4
"""Visits of a level below which it says nothing about temperature."""


@dataclass(frozen=True)
class Inputs:
    """moving: (n,) whether real acceleration is held. usable: (n,) whether a block may be fitted.

    columns: (n, m) of the levels that recur, ±1 where one of them is held.
    """

    moving: NDArray[np.bool_]
    usable: NDArray[np.bool_]
    columns: Array


def find_inputs(blocks: Blocks, deviation: Array) -> Inputs:
    """Return the real acceleration in blocks; deviation: (n,) of their means from drift model and reference."""
    usual = float(np.quantile(np.abs(np.diff(deviation)), USUAL)) if len(deviation) > 1 else 0.0
    size = max(JUMP * float(np.sqrt(np.median(blocks.white))), SHARP * usual)
    edges = np.flatnonzero((np.abs(np.diff(deviation)) > size) | (np.diff(blocks.run) != 0)) + 1
    parts = np.split(np.arange(len(deviation)), edges)
    rest = float(np.median(deviation))
    moving, usable = np.zeros(len(deviation), dtype=bool), np.ones(len(deviation), dtype=bool)
    held: list[tuple[NDArray[np.int64], float]] = []
    for part in parts:
        level = float(np.median(deviation[part])) - rest
        if abs(level) > 0.5 * size and len(part) < 0.5 * len(deviation):
            moving[part] = True
            usable[part] = False
            if len(part) >= 3:  # the first and last hold the step itself
                held.append((part[1:-1], level))
    # A block next to motion holds a part of its step.
    beside = np.zeros_like(moving)
    beside[1:] |= moving[:-1]
    beside[:-1] |= moving[1:]
    usable &= ~beside | moving
    return Inputs(moving, *_levels(held, usable))


def _levels(held: list[tuple[NDArray[np.int64], float]], usable: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], Array]:
    """Mark the blocks of levels that recur as usable, and return the columns of these."""
    columns: list[Array] = []
    usable = usable.copy()
    order = sorted(held, key=lambda item: abs(item[1]))
    groups: list[list[tuple[NDArray[np.int64], float]]] = []
    for item in order:
        if groups and abs(item[1]) <= ALIKE * abs(groups[-1][-1][1]):
            groups[-1].append(item)
        else:
            groups.append([item])
    for group in groups:
        if len(group) < FEWEST_VISITS:
            continue
        column = np.zeros(len(usable))
        for part, level in group:
            column[part] = np.sign(level)
            usable[part] = True
        columns.append(column)
    return usable, np.column_stack(columns) if columns else np.empty((len(usable), 0))
