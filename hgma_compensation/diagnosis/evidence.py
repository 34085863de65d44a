"""Bayesian least squares with one prior width for each group of columns, chosen by the evidence.

Where one cooling and one heating are all there is, a free sum of lagged temperatures fits them perfectly and the next
sweep not at all. Under a prior that is as wide as the data ask for (MacKay 1992, "Bayesian interpolation"; Tipping
2001) the sum stays tame, and the evidence compares families of models without a recording to spare.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ITERATIONS = 80
UNTIED, LEFT_OUT = -1, -2
"""Groups of columns without a prior, and of those whose weights are zero."""

FLAT = 1e4
"""Prior variance of columns that are not tied down, in units of the target's variance."""

NARROWEST = 1e-9


@dataclass(frozen=True)
class Posterior:
    """weights: (k,) mean. covariance: (k, k). log_evidence: up to what is common to all models of the same target."""

    weights: Array
    covariance: Array
    log_evidence: float

    def deviation(self, columns: Array) -> Array:
        """Return the standard deviation (n,) of predictions from columns (n, k)."""
        return np.asarray(np.sqrt(np.einsum("ij,jk,ik->i", columns, self.covariance, columns)))


def posterior(columns: Array, target: Array, groups: Sequence[int]) -> Posterior:
    """Return the posterior under the prior widths of greatest evidence.

    columns: (n, k) and target: (n,), whitened. groups: (k,) number of each column's prior width, or UNTIED, or
    LEFT_OUT.
    """
    index = np.asarray(groups)
    scale = np.linalg.norm(columns, axis=0) / np.sqrt(len(target))
    scale[scale == 0.0] = 1.0
    # One width for a group means weights of the columns as they stand: scaled only by what the group has in common.
    common = np.array([scale[index == g].mean() if g >= 0 else scale[k] for k, g in enumerate(index)])
    x = columns / common
    unit = float(target @ target) / len(target)
    variances = {g: 0.01 * unit for g in set(index.tolist()) if g >= 0}
    gram, product = x.T @ x, x.T @ target
    for _ in range(ITERATIONS):
        mean, covariance = _solve(gram, product, _prior(index, variances, unit))
        second = mean**2 + np.diag(covariance)
        variances = {g: max(float(second[index == g].mean()), NARROWEST * unit) for g in variances}
    prior = _prior(index, variances, unit)
    mean, covariance = _solve(gram, product, prior)
    return Posterior(
        mean / common, covariance / common[:, None] / common[None, :], _log_evidence(x, target, prior, mean)
    )


def average(models: Sequence[tuple[float, Posterior]]) -> tuple[Array, Array]:
    """Return the mean weights (k,) of models with their shares, and B (k, r): B Bᵀ is the covariance of the mixture.

    Bayesian model averaging (Hoeting et al. 1999): the models' disagreement is part of the uncertainty.
    """
    mean = np.sum([share * one.weights for share, one in models], axis=0)
    covariance = np.sum(
        [share * (one.covariance + np.outer(one.weights - mean, one.weights - mean)) for share, one in models], axis=0
    )
    values, vectors = np.linalg.eigh(covariance)
    return mean, vectors * np.sqrt(np.maximum(values, 0.0))


def _prior(index: NDArray[np.int64], variances: dict[int, float], unit: float) -> Array:
    """Return the prior variance (k,) of each column's weight."""
    fixed = {UNTIED: FLAT * unit, LEFT_OUT: 1e-12 * NARROWEST * unit}
    return np.array([variances[g] if g >= 0 else fixed[g] for g in index.tolist()])


def _solve(gram: Array, product: Array, prior: Array) -> tuple[Array, Array]:
    """Return mean and covariance of the weights; scaled by the prior, so that the matrix is well conditioned."""
    root = np.sqrt(prior)
    covariance = np.linalg.inv(root[:, None] * gram * root[None, :] + np.eye(len(prior)))
    covariance = root[:, None] * covariance * root[None, :]
    return covariance @ product, covariance


def _log_evidence(columns: Array, target: Array, prior: Array, mean: Array) -> float:
    residual = target - columns @ mean
    root = np.sqrt(prior)
    _, determinant = np.linalg.slogdet(np.eye(len(prior)) + root[:, None] * (columns.T @ columns) * root[None, :])
    return float(-0.5 * (residual @ residual + (mean**2 / prior).sum() + determinant))
