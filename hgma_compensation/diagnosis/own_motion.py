"""Whether a measured input moves by itself, or only as the temperature and its rate make it.

With the oven as the only source of heat, the difference of two thermometers is their different lag: a sum of the
temperature's rate and of its low-passes (with one source every transfer function of first-order bodies falls into such
partial fractions). It then says of the rate what the derivative of one noisy thermometer says less exactly, and stands
in for whatever the drift model's terms in the rate miss by that noise. What it has of its own is therefore what is left
beside the drift model *and* the effects that it is confused with, as far as that is more than the thermometers' noise.
How much of it is noise is found as SIMEX does (Cook and Stefanski 1994): the same noise once more, all is formed again,
and what is left grows by just that.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.leftover import Leftover, leftover
from hgma_compensation.diagnosis.prepare import features_at
from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.diagnosis.runs import Run, smoothed_series
from hgma_compensation.diagnosis.search import Projection, Scored, score
from hgma_compensation.diagnosis.smoothing import Smoothed
from hgma_compensation.effects.effect import Effect, normalised
from hgma_compensation.effects.registry import kinds
from hgma_compensation.recording.recording import Series
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.training.blocks import noise_of_means
from hgma_compensation.training.thermistor import usable

Array = NDArray[np.float64]

REALISATIONS = 3
"""Of the thermometers' noise."""

MOSTLY_MOTION = 0.9
"""Share of what an input has of its own that must not be the thermometers' noise: a tenth is 3 : 1 in RMS."""


@dataclass(frozen=True)
class OwnMotion:
    """What an input has of its own. share: of its energy, that is no noise. gain: of an effect of it alone, with rank.

    left: the slow part of what is left beside it and all that it is confused with.
    """

    share: float
    gain: float
    rank: int
    left: Leftover

    @property
    def moves(self) -> bool:
        """Whether the input moves by itself."""
        return self.rank > 0 and self.share >= MOSTLY_MOTION


def needs_own_motion(effect: Effect) -> bool:
    """Return whether an effect is one of a measured input that may look like an effect of the temperature."""
    return bool(effect.needs and effect.confused_with)


def own_motion(state: State, scored: Scored, slow: Array, random: np.random.Generator) -> OwnMotion:
    """Return what the input of an effect has of its own beside a state.

    slow: (n, m) as ``slow_directions`` gives it.
    """
    effect, problem = scored.effect, state.problem
    alike = look_alikes(problem, effect)
    beside = state.projection.added(alike)
    own = score(beside, [effect], [scored.columns])[0]
    before = _energy(beside, scored.columns)
    after = [_energy_again(state, effect, random) for _ in range(REALISATIONS)]
    share = 2.0 - float(np.mean(after)) / before if before > 0.0 else 0.0
    return OwnMotion(share, own.gain, own.rank, leftover(beside.added(scored.columns), slow))


def look_alikes(problem: Problem, effect: Effect) -> Array:
    """Return the columns (n, k) of all that an effect is confused with, alone and times x."""
    rivals = [one for name in effect.confused_with for one in kinds()[name].candidates(problem.survey)]
    columns = np.hstack(problem.columns(rivals))
    return np.hstack([columns, columns * normalised(problem.features[:, :1])])


def _energy(projection: Projection, columns: Array) -> float:
    """Return the whitened energy of columns (n, k) off what is known."""
    white = projection.whitener(columns)
    return float(np.sum((white - projection.known @ (projection.known.T @ white)) ** 2))


def _energy_again(state: State, effect: Effect, random: np.random.Generator) -> float:
    """Return what an effect has of its own where the thermometers' noise has been added once more."""
    problem = noisier(state.problem, random)
    known = np.hstack([problem.baseline, *state.columns])
    projection = Projection.of(state.whitener, known, problem.values).added(look_alikes(problem, effect))
    return _energy(projection, problem.columns([effect])[0])


def noisier(problem: Problem, random: np.random.Generator) -> Problem:
    """Return a problem whose thermometers have their own noise twice."""
    runs = [_noisier(run, problem.settings.noise, random) for run in problem.scene.runs]
    scene = problem.scene.with_runs(runs)
    return replace(problem, scene=scene, features=features_at(runs, problem.settings, scene.blocks), cache={})


def _noisier(run: Run, noise: TrendNoise, random: np.random.Generator) -> Run:
    first = _with_noise(run.smoothed, usable(run.recording.temperature), noise.measurement, noise, random)
    if run.second is None:
        return replace(run, smoothed=first)
    series = usable(run.recording.temperature_2)
    return replace(run, smoothed=first, second=_with_noise(run.second, series, _variance(series), noise, random))


def _variance(series: Series) -> float:
    """Return the variance of a thermometer's noise, °C²: of its samples, or of their rounding where that is more."""
    steps = np.abs(np.diff(series.values))
    step = float(steps[steps > 0.0].min()) if steps.any() else 0.0
    return max(noise_of_means(series.values) ** 2, step**2 / 12.0)


def _with_noise(
    smoothed: Smoothed, series: Series, variance: float, noise: TrendNoise, random: np.random.Generator
) -> Smoothed:
    """Return a smoothed series to whose samples noise of a variance (°C²) was added; smoothing is linear."""
    drawn = np.sqrt(variance) * random.standard_normal(len(series.stamps))
    added = smoothed_series(Series(series.stamps, drawn), noise)
    return replace(smoothed, temperature=smoothed.temperature + added.temperature, rate=smoothed.rate + added.rate)
