"""Whether an effect of a given size would predict the cycles or stretches that are left out of its fit."""

from dataclasses import replace

import numpy as np

from hgma_compensation.coverage.sensitivity import Point
from hgma_compensation.diagnosis.cross_validation import folds_for, share_of_folds
from hgma_compensation.diagnosis.forward import LEAST_FOLDS
from hgma_compensation.diagnosis.problem import State

TRIALS = 3
LARGER = 1.5
MOST_LARGER = 6
"""Times that a size is raised by LARGER, to eleven times what the thresholds of the search ask for."""


def confirmed(state: State, point: Point, random: np.random.Generator) -> Point | None:
    """Return the point at the size that most of TRIALS surrogate recordings confirm, None where none does.

    A surrogate is noise of the state's model and the effect, in place of the values.
    """
    (columns,) = state.problem.columns([point.form])
    folds = folds_for(state, point.form)
    if len(np.unique(folds)) < 2:
        return None
    noises = [_noise(state, random) for _ in range(TRIALS)]
    for step in range(MOST_LARGER + 1):
        factor = LARGER**step
        shares = []
        for noise in noises:
            values = noise + factor * point.values
            blocks = replace(state.problem.scene.blocks, values=values)
            problem = replace(state.problem, scene=replace(state.problem.scene, blocks=blocks))
            share, fall = share_of_folds(replace(state, problem=problem), columns, folds)
            shares.append(share >= LEAST_FOLDS - 1e-9 and fall > 0.0)
        if 2 * sum(shares) > TRIALS:
            return replace(point, size=factor * point.size, values=factor * point.values)
    return None


def _noise(state: State, random: np.random.Generator) -> np.ndarray:
    """Return noise (n,) with the covariance of the state's model."""
    noise = np.empty(len(state.problem.values))
    for factor, place in zip(state.whitener.factors, state.whitener.places, strict=True):
        noise[place] = factor @ random.standard_normal(len(place))
    return noise
