"""The methods of training side by side: the same means, the same folds, the error on what each fit has not seen."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from hgma_compensation.drift.inputs import Array
from hgma_compensation.drift.model import DriftModel
from hgma_compensation.drift.polynomial import CUBIC, CUBIC_WITH_RATE
from hgma_compensation.drift.radial_basis import RadialBasisDrift, basis
from hgma_compensation.training.folds import Folds
from hgma_compensation.training.genetic import PLAIN_PENALTY, GeneticSettings
from hgma_compensation.training.gradient import train_by_gradient
from hgma_compensation.training.linear_algebra import one_thread
from hgma_compensation.training.methods import Method, fit_drift
from hgma_compensation.training.polynomial_fit import fit_polynomial
from hgma_compensation.training.ridge import solve_ridge

Search = Callable[[int, float], None]
"""Hears the generation and the best error of the genetic search."""


@dataclass(frozen=True)
class Material:
    """What every method is given. features: (n, 3). target: (n,) drift. noise: of one target, in its unit."""

    features: Array
    target: Array
    folds: Folds
    noise: float
    seed: int
    settings: GeneticSettings


@dataclass(frozen=True)
class MethodResult:
    """drift: fitted to all. fit: its RMS error. left_out: (n,) error of each mean, of a fit that has not seen its fold.

    seconds: that the fit took; None where it was not timed.
    """

    method: Method
    drift: DriftModel
    fit: float
    left_out: Array
    seconds: float | None

    @property
    def cross_validated(self) -> float:
        """RMS of the errors on left-out folds."""
        return float(np.sqrt(np.mean(self.left_out**2)))

    def of_folds(self, folds: Folds) -> list[float]:
        """Return the RMS on each fold left out."""
        return [float(np.sqrt(np.mean(self.left_out[folds.index == fold] ** 2))) for fold in range(folds.count)]


def compare_methods(material: Material, *, chosen: tuple[Method, DriftModel], search: Search) -> Iterator[MethodResult]:
    """Yield the result of every method, the plainest first.

    chosen: of which the drift model is known; a genetic search is then not run again, and so not timed. search: hears
    of the one that is run.
    """
    with one_thread():
        pass  # loads its library, which the time of the first method should not hold
    for method in (Method.POLYNOMIAL, Method.POLYNOMIAL_RATE, Method.RBF, Method.RBF_GA):
        yield _result(material, method, *_fitted(material, method, chosen, search))


def _fitted(
    material: Material, method: Method, chosen: tuple[Method, DriftModel], search: Search
) -> tuple[DriftModel, float | None]:
    if method is chosen[0] is Method.RBF_GA:
        return chosen[1], None
    began = perf_counter()
    fit = fit_drift(
        method,
        material.features,
        material.target,
        material.folds,
        seed=material.seed,
        noise=material.noise,
        settings=material.settings,
        progress=search,
    )
    return chosen[1] if method is chosen[0] else fit.drift, perf_counter() - began


@one_thread()
def _result(material: Material, method: Method, drift: DriftModel, seconds: float | None) -> MethodResult:
    left_out = np.empty(len(material.target))
    refit = _refit(material, method, drift)
    for fold in range(material.folds.count):
        out = material.folds.index == fold
        left_out[out] = material.target[out] - refit(~out)(material.features[out])
    residual = material.target - drift.evaluate(material.features)
    return MethodResult(method, drift, float(np.sqrt(np.mean(residual**2))), left_out, seconds)


def _refit(material: Material, method: Method, drift: DriftModel) -> Callable[[Array], Callable[[Array], Array]]:
    """Return what fits the method to some rows (n,) and returns the model of features (k, 3)."""
    features, target = material.features, material.target
    if method is Method.RBF:
        return lambda rows: train_by_gradient(features[rows], target[rows], seed=material.seed).evaluate
    if method is not Method.RBF_GA or not isinstance(drift, RadialBasisDrift):
        exponents = CUBIC if method is Method.POLYNOMIAL else CUBIC_WITH_RATE
        return lambda rows: fit_polynomial(features[rows], target[rows], exponents).evaluate
    network, penalty = drift, ridge_penalty(drift, features, target)

    def of_rows(rows: Array) -> Callable[[Array], Array]:
        weights = solve_ridge(_columns(network, features[rows]), target[rows], penalty)
        return lambda at: np.asarray(_columns(network, at) @ weights)

    return of_rows


def ridge_penalty(network: RadialBasisDrift, features: Array, target: Array) -> Array:
    """Return the penalty (k,) of the ridge fit that gave a network its weights, which no calibration holds.

    At the minimum of |Φw - y|² + n λ|w|² (``solve_ridge``) Φᵀ(y - Φw) = n λ w for the Gaussians' weights w.
    """
    columns = _columns(network, features)
    count = len(network.weights)
    pull = columns[:, :count].T @ (target - network.evaluate(features))
    energy = len(target) * float(network.weights @ network.weights)
    found = max(float(pull @ network.weights) / energy, PLAIN_PENALTY) if energy > 0.0 else PLAIN_PENALTY
    return np.r_[np.full(count, found), np.full(columns.shape[1] - count, PLAIN_PENALTY)]


def _columns(network: RadialBasisDrift, features: Array) -> Array:
    return basis(network.scaling.apply(features), network.centres, network.widths)
