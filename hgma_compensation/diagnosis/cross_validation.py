"""Whether an effect predicts data that its gains were not fitted to."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.problem import Problem, State, scaled_least_squares
from hgma_compensation.effects.effect import Effect
from hgma_compensation.training.blocks import Blocks as TrainingBlocks
from hgma_compensation.training.folds import cycle_folds, half_cycles

Array = NDArray[np.float64]

INTERLEAVED = 240.0
"""s: blocks of events, time and lines are left out in stretches of this length."""

TIME_FOLDS = 6


def folds_for(state: State, effect: Effect) -> NDArray[np.int64]:
    """Return the fold (n,) of each block: cycles where temperature drives the effect, else stretches of time."""
    blocks = state.problem.scene.blocks
    if effect.folds_in_time or effect.per_sample:
        seconds = (blocks.stamps - blocks.stamps.min()) * 1e-9
        return np.asarray(np.floor(seconds / INTERLEAVED).astype(np.int64) % TIME_FOLDS)
    return cycle_folds(_training_blocks(state.problem)).index


def sweeps(problem: Problem) -> int:
    """Return the number of coolings and heatings in a problem."""
    return int(half_cycles(_training_blocks(problem)).max()) + 1


def _training_blocks(problem: Problem) -> TrainingBlocks:
    blocks = problem.scene.blocks
    seconds = (blocks.stamps - blocks.stamps.min()) * 1e-9
    return TrainingBlocks(seconds, blocks.run, problem.features, blocks.values[:, None])


def share_of_folds(state: State, columns: Array, folds: NDArray[np.int64]) -> tuple[float, float]:
    """Return the share of folds that columns (n, k) predict better, and the fall of their whitened error in all."""
    white = state.whitener(columns)
    known = state.projection.known
    target = state.whitener(state.problem.values)
    both = np.hstack([known, white])
    better, total, counted = 0, 0.0, 0
    for fold in np.unique(folds):
        out = folds == fold
        if out.all():
            continue
        errors = [
            float(np.sum((target[out] - x[out] @ scaled_least_squares(x[~out], target[~out])) ** 2))
            for x in (known, both)
        ]
        better += errors[1] < errors[0]
        total += errors[0] - errors[1]
        counted += 1
    return better / max(counted, 1), total
