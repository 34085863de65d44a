"""The ways of fitting a drift model, under one signature."""

from dataclasses import dataclass, replace
from enum import Enum
from math import inf

from hgma_compensation.drift.inputs import Array
from hgma_compensation.drift.model import DriftModel
from hgma_compensation.drift.polynomial import CUBIC, CUBIC_WITH_RATE
from hgma_compensation.training.folds import Folds
from hgma_compensation.training.genetic import (
    PLAIN_PENALTY,
    Criterion,
    GeneticResult,
    GeneticSettings,
    Progress,
    search_network,
)
from hgma_compensation.training.gradient import train_by_gradient
from hgma_compensation.training.linear_algebra import one_thread
from hgma_compensation.training.polynomial_fit import fit_polynomial, polynomial_fitness

STRAIGHT = (20.0, 1000.0)
"""Widths of the inputs after the first, in standard deviations, where drift is to answer to them in proportion."""

GAIN = 0.1
"""Share by which the error on left-out folds must be lower to prove one network better than another."""

SEARCHES = 3
"""That ``choose_network`` makes at most."""


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
        found = choose_network(features, target, folds, seed=seed, stop_at=noise, settings=settings, progress=progress)
        return Fit(found.drift, found.fitness)
    if method is Method.RBF:
        return Fit(train_by_gradient(features, target, seed=seed), None)
    exponents = CUBIC if method is Method.POLYNOMIAL else CUBIC_WITH_RATE
    drift = fit_polynomial(features, target, exponents)
    return Fit(drift, polynomial_fitness(features, target, exponents, folds))


def choose_network(
    features: Array,
    target: Array,
    folds: Folds,
    *,
    seed: int,
    stop_at: float,
    settings: GeneticSettings,
    progress: Progress | None = None,
) -> GeneticResult:
    """Search a network straight in all inputs but the first, then one that may bend in them; return the one proven.

    Arguments are those of ``search_network``. Few cycles leave the curvature in rate and product undetermined, and what
    is then found misleads at a rate not seen: the simpler network is kept unless the other is better by GAIN on the
    folds left out, a fixed margin in the spirit of the one-standard-error rule (Breiman et al. 1984, section 3.4.3).
    Folds cannot tell straight networks apart that differ by less, and their least error is partly luck: a third search,
    for the likeliest of all straight networks, replaces the first unless that is proven better. No further search where
    the first comes down to ``stop_at``. progress hears of all as if they were one; it ends early where one is left out.
    """
    rest = len(settings.widths) - 1
    unbent = replace(settings, widths=(settings.widths[0], *(STRAIGHT,) * rest))

    def hear(number: int, generation: int, left_out: float) -> None:
        if progress is not None:
            progress((number * settings.generations + generation + SEARCHES - 1) // SEARCHES, left_out)

    def search(number: int, own: GeneticSettings, criterion: Criterion, best: float) -> GeneticResult:
        """Make the search of that number; best: error on left-out folds of those before it."""

        def report(generation: int, fitness: float) -> None:
            if criterion is Criterion.LEFT_OUT:
                hear(number, generation, min(fitness, best))
            elif generation < settings.generations:  # the last is heard of when its error on the folds is known
                hear(number, generation, best)

        return search_network(
            features,
            target,
            folds,
            seed=seed,
            stop_at=stop_at if criterion is Criterion.LEFT_OUT else 0.0,
            settings=own,
            criterion=criterion,
            progress=report,
        )

    straight = search(0, unbent, Criterion.LEFT_OUT, inf)
    if straight.fitness <= stop_at:
        return straight
    bent = search(1, settings, Criterion.LEFT_OUT, straight.fitness)
    if _proven(bent, straight):
        return bent
    smooth = replace(unbent, ridge=(PLAIN_PENALTY, settings.ridge[1]))
    best = min(straight.fitness, bent.fitness)
    likeliest = search(2, smooth, Criterion.LIKELIHOOD, best)
    hear(2, settings.generations, min(best, likeliest.fitness))
    return straight if _proven(straight, likeliest) else likeliest


def _proven(one: GeneticResult, other: GeneticResult) -> bool:
    """Return whether the folds prove the one better than the other."""
    return one.fitness < (1.0 - GAIN) * other.fitness
