"""Whether a measured input moves by itself, or only as the temperature and its rate make it.

With the oven as the only source of heat, the difference of two thermometers is their different lag: a sum of the
temperature's rate and of its low-passes (with one source every transfer function of first-order bodies falls into such
partial fractions). It then says of the rate what the derivative of one noisy thermometer says less exactly, and stands
in for whatever the drift model's terms in temperature and rate miss by that noise. What it has of its own is therefore
what is left beside the drift model *and* the effects that it is confused with, as far as that is more than the noise of
the smoothed thermometers. How much is noise is found as SIMEX does (Cook and Stefanski 1994): the same noise is added
once more and all is formed again; what is left grows by just that, and what the drift model then misses brings as much.
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

MOSTLY_MOTION = 0.7
"""Share of what an input has of its own that must not be noise: half and more can be the smoother's lag at corners."""


@dataclass(frozen=True)
class OwnMotion:
    """What an input has of its own. share: of its energy, that is no noise. scored: the effect by that alone.

    stolen: gain that the thermometers' noise alone would bring. left: the slow part of what is left beside the effect
    and all that it is confused with.
    """

    share: float
    scored: Scored
    stolen: float
    left: Leftover

    @property
    def moves(self) -> bool:
        """Whether the input moves by itself."""
        return self.scored.rank > 0 and self.share >= MOSTLY_MOTION

    @property
    def gain(self) -> float:
        """Gain of the effect beyond what the noise brings, which adds to it in amplitude."""
        return float(max(np.sqrt(self.scored.gain) - np.sqrt(self.stolen), 0.0) ** 2)


def needs_own_motion(effect: Effect) -> bool:
    """Return whether an effect is one of a measured input that may look like an effect of the temperature."""
    return bool(effect.needs and effect.confused_with)


def own_motion(state: State, scored: Scored, slow: Array, random: np.random.Generator) -> OwnMotion:
    """Return what the input of an effect has of its own beside a state.

    slow: (n, m) as ``slow_directions`` gives it.
    """
    effect = scored.effect
    beside = state.projection.added(look_alikes(state.problem, effect))
    own = score(beside, [effect], [scored.columns])[0]
    energy = _energy(beside, scored.columns)
    if not own.rank or not energy:
        return OwnMotion(0.0, own, 0.0, leftover(beside, slow))
    again = [_again(state, effect, random) for _ in range(REALISATIONS)]
    grown = float(np.mean([one[0] for one in again])) / energy
    # That is the gain of the noise once, in an input that has it twice.
    stolen = grown * float(np.mean([one[1] for one in again]))
    return OwnMotion(2.0 - grown, own, stolen, leftover(beside.added(scored.columns), slow))


def look_alikes(problem: Problem, effect: Effect) -> Array:
    """Return the columns (n, k) of all that an effect is confused with, alone and times x."""
    rivals = [one for name in effect.confused_with for one in kinds()[name].candidates(problem.survey)]
    columns = np.hstack(problem.columns(rivals))
    return np.hstack([columns, columns * normalised(problem.features[:, :1])])


def _energy(projection: Projection, columns: Array) -> float:
    """Return the whitened energy of columns (n, k) off what is known."""
    white = projection.whitener(columns)
    return float(np.sum((white - projection.known @ (projection.known.T @ white)) ** 2))


def _again(state: State, effect: Effect, random: np.random.Generator) -> tuple[float, float]:
    """Return the energy that an effect has of its own under twice the noise, and the gain that the added one brings."""
    problem = noisier(state.problem, random)
    before, known = (np.hstack([one.baseline, *state.columns]) for one in (state.problem, problem))
    weights, _ = state.fit()
    beside = Projection.of(state.whitener, known, (before - known) @ weights).added(look_alikes(problem, effect))
    columns = problem.columns([effect])[0]
    return _energy(beside, columns), score(beside, [effect], [columns])[0].gain


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
