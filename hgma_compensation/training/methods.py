"""The ways of fitting a drift model, under one signature."""

from dataclasses import dataclass
from enum import Enum

from hgma_compensation.drift.inputs import Array
from hgma_compensation.drift.model import DriftModel
from hgma_compensation.drift.polynomial import CUBIC, CUBIC_WITH_RATE
from hgma_compensation.training.folds import Folds
from hgma_compensation.training.genetic import GeneticSettings, Progress, search_network
from hgma_compensation.training.gradient import train_by_gradient
from hgma_compensation.training.linear_algebra import one_thread
from hgma_compensation.training.polynomial_fit import fit_polynomial, polynomial_fitness


class Method(str, Enum):
    """How a drift model is fitted.

    RBF_GA: network whose centres and widths a genetic search finds. RBF: network trained by Eq. (6).
    POLYNOMIAL: cubic in temperature, as PX4 and ArduPilot fit it. POLYNOMIAL_RATE: with Ṫ and T·Ṫ.
    """

    RBF_GA = "rbf-ga"
    RBF = "rbf"
    POLYNOMIAL = "polynomial"
    POLYNOMIAL_RATE = "polynomial-rate"


@dataclass(frozen=True)
class Fit:
    """A drift model, and its RMS error on left-out folds where the method has one."""

    drift: DriftModel
    cross_validated: float | None


@one_thread()
def fit_drift(
    method: Method,
    features: Array,
    target: Array,
    folds: Folds,
    *,
    seed: int,
    noise: float,
    settings: GeneticSettings,
    progress: Progress | None = None,
) -> Fit:
    """Fit one channel: features (n, 3), target (n,) drift, noise of one target in its unit."""
    if method is Method.RBF_GA:
        found = search_network(features, target, folds, seed=seed, stop_at=noise, settings=settings, progress=progress)
        return Fit(found.drift, found.fitness)
    if method is Method.RBF:
        return Fit(train_by_gradient(features, target, seed=seed), None)
    exponents = CUBIC if method is Method.POLYNOMIAL else CUBIC_WITH_RATE
    drift = fit_polynomial(features, target, exponents)
    return Fit(drift, polynomial_fitness(features, target, exponents, folds))
