"""Least-squares fit of a polynomial drift."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.drift.inputs import Array, InputScaling
from hgma_compensation.drift.polynomial import PolynomialDrift, monomials
from hgma_compensation.training.folds import Folds
from hgma_compensation.training.ridge import cross_validated_rms, solve_ridge

PENALTY = 1e-12
"""Keeps a feature that never varied from being singular."""


def fit_polynomial(features: Array, target: Array, exponents: NDArray[np.int64]) -> PolynomialDrift:
    """Return the polynomial of features (n, d) closest to the drift (n,)."""
    scaling = InputScaling.of(features)
    columns = monomials(scaling.apply(features), exponents)
    return PolynomialDrift(scaling, exponents, solve_ridge(columns, target, np.full(len(exponents), PENALTY)))


def polynomial_fitness(features: Array, target: Array, exponents: NDArray[np.int64], folds: Folds) -> float:
    """Return the RMS error on left-out folds, in the target's unit."""
    columns = monomials(InputScaling.of(features).apply(features), exponents)
    penalty = np.full((1, len(exponents)), PENALTY)
    return float(cross_validated_rms(columns[None], target, penalty, folds.index)[0])
