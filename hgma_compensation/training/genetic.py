"""Genetic search of the network's centres and widths: the five steps of Zhu et al. 2019, section 3.2.

1 population: random centres inside the data, widths and ridge penalty log-uniform in their ranges.
2 fitness: RMS error on temperature cycles left out of the fit, or the marginal likelihood of all of them; the weights
  are not searched but solved by ridge least squares for each candidate (variable projection, Golub and Pereyra 1973).
3 selection, 4 crossover, 5 mutation: binary tournament, simulated binary crossover and polynomial
  mutation (Deb and Agrawal 1995), as pymoo implements them. Stop at fitness < δ or the last generation.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.callback import Callback
from pymoo.core.problem import Problem
from pymoo.core.termination import TerminateIfAny, Termination
from pymoo.optimize import minimize
from pymoo.termination.max_gen import MaximumGenerationTermination

from hgma_compensation.drift.inputs import Array, InputScaling
from hgma_compensation.drift.radial_basis import RadialBasisDrift, basis
from hgma_compensation.training.folds import Folds
from hgma_compensation.training.likelihood import marginal_error
from hgma_compensation.training.ridge import LeftOutFolds, solve_ridge

Progress = Callable[[int, float], None]
"""Called after each generation with its number and the best fitness so far."""

PLAIN_PENALTY = 1e-9
"""Of bias and linear terms: none that matters, enough to keep a constant feature from being singular."""

PIECE = 10
"""Candidates evaluated at once: their columns stay in a core's cache, and no call is so short that calling counts."""


class Criterion(Enum):
    """What a candidate is judged by.

    LEFT_OUT: its error on left-out folds, which supposes nothing of the noise. LIKELIHOOD: ``marginal_error`` of all
    samples, which tells candidates apart much more finely where what is left of them is noise, and misleads where the
    cycles differ by more than that.
    """

    LEFT_OUT = "left out"
    LIKELIHOOD = "likelihood"


@dataclass(frozen=True)
class GeneticSettings:
    """Size and bounds of the search.

    widths: (lower, upper) of each input, in its standard deviations. Drift bends with temperature but
    answers to rate and product almost linearly, so their Gaussians are wide; narrow ones fit one sweep
    and mislead on the next. ridge: bounds of the penalty of the Gaussians' weights, per sample of a
    target of unit variance.
    """

    centres: int = 8
    population: int = 60
    generations: int = 200
    widths: tuple[tuple[float, float], ...] = ((0.3, 3.0), (2.0, 20.0), (2.0, 20.0))
    ridge: tuple[float, float] = (1e-7, 1e-2)


@dataclass(frozen=True)
class GeneticResult:
    """The best network, its RMS error on left-out folds in the unit of the target, and how many generations it took."""

    drift: RadialBasisDrift
    fitness: float
    generations: int


class _Candidates(Problem):
    """The population: genes are centres, log widths and log ridge penalty."""

    def __init__(
        self, inputs: Array, target: Array, folds: Folds, settings: GeneticSettings, criterion: Criterion
    ) -> None:
        self._folds, self._centres, self._criterion = LeftOutFolds.of(folds.index), settings.centres, criterion
        # Samples last in memory: the loops over them are the long ones.
        self._inputs, self._target = np.asfortranarray(inputs[self._folds.order]), target[self._folds.order]
        low, high = np.log(np.array(settings.widths)).T
        ridge = np.log(settings.ridge)
        lower = np.concatenate(
            [np.tile(inputs.min(axis=0), settings.centres), np.tile(low, settings.centres), ridge[:1]]
        )
        upper = np.concatenate(
            [np.tile(inputs.max(axis=0), settings.centres), np.tile(high, settings.centres), ridge[1:]]
        )
        super().__init__(n_var=len(lower), n_obj=1, xl=lower, xu=upper)

    def decode(self, genes: Array) -> tuple[Array, Array, Array]:
        """Return centres (p, m, d), widths (p, m, d) and penalties (p, k) of genes (p, v)."""
        shape = (len(genes), self._centres, self._inputs.shape[1])
        size = self._centres * self._inputs.shape[1]
        penalty = np.full((len(genes), self._centres + 1 + shape[2]), PLAIN_PENALTY)
        penalty[:, : self._centres] = np.exp(genes[:, -1:])
        return genes[:, :size].reshape(shape), np.exp(genes[:, size:-1]).reshape(shape), penalty

    def _evaluate(self, genes: Array, out: dict[str, Array], *_: object, **__: object) -> None:
        parts = [genes[start : start + PIECE] for start in range(0, len(genes), PIECE)]
        out["F"] = np.concatenate(list(map(self._fitness, parts)))

    def _fitness(self, genes: Array) -> Array:
        """Return the fitness (p,) of genes (p, v); of each alone, whatever others it is asked with."""
        if self._criterion is Criterion.LEFT_OUT:
            return self.left_out(genes)
        centres, widths, penalty = self.decode(genes)
        return marginal_error(basis(self._inputs, centres, widths), self._target, penalty, self._centres)

    def left_out(self, genes: Array) -> Array:
        """Return the RMS error (p,) of genes (p, v) on left-out folds."""
        centres, widths, penalty = self.decode(genes)
        return self._folds.rms(basis(self._inputs, centres, widths), self._target, penalty)


class _Reached(Termination):
    """Step five of the paper: stop at fitness < δ; pymoo's own divides by δ, which may be 0."""

    def __init__(self, delta: float) -> None:
        super().__init__()
        self._delta = delta

    def _update(self, algorithm: GA) -> float:
        return float(algorithm.opt[0].F[0] <= self._delta)


class _Report(Callback):
    def __init__(self, progress: Progress | None, unit: float) -> None:
        super().__init__()
        self._progress, self._unit = progress, unit

    def notify(self, algorithm: GA) -> None:
        if self._progress is not None:
            self._progress(int(algorithm.n_gen), float(algorithm.opt[0].F[0]) * self._unit)


def search_network(
    features: Array,
    target: Array,
    folds: Folds,
    *,
    seed: int,
    stop_at: float,
    settings: GeneticSettings | None = None,
    criterion: Criterion = Criterion.LEFT_OUT,
    progress: Progress | None = None,
) -> GeneticResult:
    """Search the network for one channel; the same seed gives the same network.

    features: (n, d). target: (n,) drift. stop_at: δ of the criterion, in the target's unit.
    """
    settings = settings or GeneticSettings()
    scaling, unit = InputScaling.of(features), float(target.std()) or 1.0
    inputs, scaled = scaling.apply(features), target / unit
    problem = _Candidates(inputs, scaled, folds, settings, criterion)
    stop = TerminateIfAny(MaximumGenerationTermination(settings.generations), _Reached(stop_at / unit))
    found = minimize(
        problem,
        GA(pop_size=settings.population),
        stop,
        seed=seed,
        callback=_Report(progress, unit),
        copy_termination=False,
    )
    genes = np.atleast_2d(found.X)
    centres, widths, penalty = (part[0] for part in problem.decode(genes))
    weights = solve_ridge(basis(inputs, centres, widths), target, penalty)
    m = settings.centres
    drift = RadialBasisDrift(scaling, centres, widths, weights[:m], float(weights[m]), weights[m + 1 :])
    left_out = float(found.F[0]) if criterion is Criterion.LEFT_OUT else float(problem.left_out(genes)[0])
    return GeneticResult(drift, left_out * unit, int(found.algorithm.n_gen) - 1)
