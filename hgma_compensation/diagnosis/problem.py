"""One channel's question: its blocks, the baseline that is never an effect, its noise."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.baseline import independent, regressors
from hgma_compensation.diagnosis.evidence import average, posterior
from hgma_compensation.diagnosis.noise_fit import ThermistorError, fit_noise
from hgma_compensation.diagnosis.noise_model import NoiseModel
from hgma_compensation.diagnosis.scene import Scene
from hgma_compensation.diagnosis.search import Projection, Scored, score
from hgma_compensation.diagnosis.whitener import Whitener
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.effects.effect import Effect, Survey
from hgma_compensation.temperature.features import FeatureSettings

Array = NDArray[np.float64]

SLOPE_STEP = 0.1
"""°C over which the drift's slope is taken."""

MOST_KEPT = 8 << 20
"""Bytes of columns that are kept: those of the grid, two or three hundred, and the last that were polished."""

TRUSTED = 3e-5
"""Singular value over the largest below which a combination of columns is not determined by the data."""

RIDGE = 1e-8
"""Penalty of scaled columns: none that matters to a column that the data determine."""


@dataclass(frozen=True)
class Problem:
    """What is asked of a channel.

    scene: with the blocks to learn from. features: (n, 3) at the blocks. network: whose weights are free.
    inputs: (n, m) columns of real acceleration that must not be taken for drift. block: s. settings: of the features.
    """

    scene: Scene
    features: Array
    network: RadialBasisDrift
    inputs: Array
    block: float
    thermistor: ThermistorError
    survey: Survey
    settings: FeatureSettings
    cache: dict[Effect, Array] = field(default_factory=dict, compare=False, repr=False)

    def columns(self, effects: Sequence[Effect]) -> list[Array]:
        """Return the columns (n, k) of each effect; kept for a while, since no state of the search changes them."""
        new = list(dict.fromkeys(effect for effect in effects if effect not in self.cache))
        self.cache.update(zip(new, self.scene.columns(new), strict=True))
        for effect in dict.fromkeys(effects):
            self.cache[effect] = self.cache.pop(effect)  # the last that were asked for are the last to go
        found = [self.cache[effect] for effect in effects]
        held = sum(columns.nbytes for columns in self.cache.values())
        for effect in list(self.cache):
            if held <= MOST_KEPT:
                break
            held -= self.cache.pop(effect).nbytes
        return found

    def forget(self, kept: Collection[Effect]) -> None:
        """Let go of the columns of all effects but some; they are formed again where they are asked for."""
        for effect in [effect for effect in self.cache if effect not in kept]:
            del self.cache[effect]

    @property
    def values(self) -> Array:
        """Means (n,) of the channel."""
        return self.scene.blocks.values

    @cached_property
    def baseline(self) -> Array:
        """Return the columns (n, k) of network and inputs."""
        return np.hstack([regressors(self.network, self.features), self.inputs])

    def slope(self, weights: Array) -> Array:
        """Return d drift / dT (n,) under weights of the network."""
        shift = np.array([SLOPE_STEP, 0.0, 0.0])
        size = regressors(self.network, self.features[:1]).shape[1]
        higher, lower = (regressors(self.network, self.features + s) for s in (shift, -shift))
        return np.asarray((higher - lower) @ weights[:size] / (2.0 * SLOPE_STEP))


@dataclass(frozen=True)
class State:
    """A problem with some effects taken as explained, and the noise under which it is judged.

    priors: shares of models whose weights have priors, and the groups of the columns in each (see ``posterior``);
    without any the weights are those of least squares.
    """

    problem: Problem
    noise: NoiseModel
    whitener: Whitener
    effects: tuple[Effect, ...]
    columns: tuple[Array, ...]
    priors: tuple[tuple[float, tuple[int, ...]], ...] = ()

    @classmethod
    def of(cls, problem: Problem, effects: Sequence[Effect]) -> "State":
        """Fit the noise beside baseline and effects."""
        columns = problem.columns(effects)
        known = np.hstack([problem.baseline, *columns])
        weights = scaled_least_squares(known, problem.values)
        residual = problem.values - known @ weights
        carried = np.abs(problem.slope(weights)) * problem.thermistor.deviation
        noise = fit_noise(
            problem.scene.blocks, residual, independent(known), (carried, problem.thermistor.correlation), problem.block
        )
        blocks = problem.scene.blocks
        return cls(problem, noise, noise.whitener(blocks.run, blocks.stamps), tuple(effects), tuple(columns))

    @cached_property
    def projection(self) -> Projection:
        """The whitened problem without baseline and effects."""
        return Projection.of(self.whitener, self.known, self.problem.values)

    def score(self, effects: Sequence[Effect]) -> list[Scored]:
        """Return effects scored beside those that the state has."""
        return score(self.projection, effects, self.problem.columns(effects))

    def with_effects(self, effects: Sequence[Effect], columns: Sequence[Array]) -> "State":
        """Return the state with other effects under the same noise."""
        return State(self.problem, self.noise, self.whitener, tuple(effects), tuple(columns))

    @property
    def left(self) -> float:
        """Whitened energy that is left."""
        return float(self.projection.residual @ self.projection.residual)

    @property
    def known(self) -> Array:
        """Columns (n, k) of baseline and effects."""
        return np.hstack([self.problem.baseline, *self.columns])

    @cached_property
    def solution(self) -> tuple[Array, Array]:
        """Weights of the known columns, as ``solve`` gives them; kept, since a covariance in a file is read for them.

        The report asks for them once more, where the memory for that would come on top of what drawing takes.
        """
        return self.solve(self.known)

    def fit(self) -> tuple[Array, Array]:
        """Return generalised least-squares weights of [baseline, effects] and the residual (n,), not whitened."""
        weights, _ = self.solution
        return weights, self.problem.values - self.known @ weights

    def solve(self, known: Array) -> tuple[Array, Array]:
        """Return the weights (k,) of columns (n, k), and B (k, r): B Bᵀ is their covariance."""
        white, target = self.whitener(known), self.whitener(self.problem.values)
        if not self.priors:
            return scaled_least_squares(white, target), covariance_root(white)
        return average([(share, posterior(white, target, groups)) for share, groups in self.priors])


def covariance_root(white: Array) -> Array:
    """Return B (k, r): B Bᵀ is the covariance of least-squares weights of whitened columns (n, k)."""
    scale = np.linalg.norm(white, axis=0)
    scale[scale == 0.0] = 1.0
    _, s, vt = np.linalg.svd(white / scale, full_matrices=False)
    good = s > TRUSTED * s[0]
    return np.asarray((vt[good].T / s[good]) / scale[:, None])


def scaled_least_squares(columns: Array, target: Array) -> Array:
    """Return the weights (k,) of columns (n, k) under a ridge that only ties down what is not determined."""
    scale = np.linalg.norm(columns, axis=0) / np.sqrt(len(target))
    scale[scale == 0.0] = 1.0
    rows = np.sqrt(RIDGE * len(target)) * np.eye(columns.shape[1])
    augmented = np.vstack([columns / scale, rows])
    solution, *_ = np.linalg.lstsq(augmented, np.concatenate([target, np.zeros(columns.shape[1])]), rcond=None)
    return np.asarray(solution / scale)


def without_rows(problem: Problem, rows: NDArray[np.bool_]) -> Problem:
    """Return the problem on the rows that are true."""
    blocks = problem.scene.blocks
    kept = type(blocks)(*(getattr(blocks, name)[rows] for name in type(blocks).__dataclass_fields__))
    return replace(
        problem,
        scene=replace(problem.scene, blocks=kept, moving=problem.scene.moving[rows]),
        features=problem.features[rows],
        inputs=problem.inputs[rows],
        cache={},
    )
