"""One cooling and one heating: spectra of memories under a prior, in place of single effects.

With fewer than two cycles nothing can be left out to validate an effect, and several memories explain a loop equally
well. So no single one is picked: thermal lags from seconds to half an hour and plays from 1 to 32 °C all take part,
each kind with a prior as wide as the evidence wants it, and families of them are averaged by their evidence. A family
that does not know what the sweep back would do takes no part, however well it fits.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import gumbel_r

from hgma_compensation.diagnosis.evidence import LEFT_OUT, UNTIED, Posterior, posterior
from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.diagnosis.runs import Run
from hgma_compensation.diagnosis.scene import Scene
from hgma_compensation.diagnosis.smoothing import Smoothed
from hgma_compensation.effects.effect import Effect, Survey
from hgma_compensation.effects.hysteresis import Hysteresis
from hgma_compensation.effects.thermal_lag import ThermalLag

Array = NDArray[np.float64]

LAG_MIDDLE, LAG_POLES = 113.0, 8.0
"""s, geometric middle of poles from 10 to 1280 s, each twice as slow as the one before."""

PLAY_MIDDLE, PLAYS = 5.66, 6.0
"""°C, geometric middle of plays from 1 to 32 °C."""

BENDS = (3.0, 4.0, 5.0, 6.0, 8.0)
"""Numbers of Gaussians of the lags' map that are compared."""

STATIC, LAG, LAG_MAP, PLAY = 0, 1, 2, 3
"""Groups of columns that share a prior width."""

SURROGATES = 40

NAMED = 0.1
"""RMS of a kind of memory over that of the largest, below which it is not named."""


@dataclass(frozen=True)
class Family:
    """Memories that take part, and the groups of all columns. deviation: of the sweep back, mean, channel's unit."""

    effects: tuple[Effect, ...]
    groups: tuple[int, ...]
    posterior: Posterior
    deviation: float

    @property
    def title(self) -> str:
        """Return the kinds in words."""
        bent = any(isinstance(e, ThermalLag) and e.centres for e in self.effects)
        names = [e.name + (" with a bent map" if bent and isinstance(e, ThermalLag) else "") for e in self.effects]
        return " and ".join(names) or "no memory"


@dataclass(frozen=True)
class Spectra:
    """families: by evidence, greatest first; chosen: the first that knows the sweep back. p_value: of its memories.

    shares: of chosen and the families that are parts of it, in the average. static: RMS that a map of the present
    temperature leaves; deviations beyond it say nothing.
    """

    families: tuple[Family, ...]
    chosen: Family
    shares: tuple[tuple[float, Family], ...]
    p_value: float
    static: float

    def carrying(self, state: State) -> tuple[Effect, ...]:
        """Return the memories of the state that carry a share worth a name."""
        weights, _ = state.fit()
        sizes = [columns.shape[1] for columns in state.columns]
        parts = np.split(weights[len(weights) - sum(sizes) :], np.cumsum(sizes)[:-1]) if sizes else []
        carried = [float(np.std(c @ w)) for c, w in zip(state.columns, parts, strict=True)]
        return tuple(e for e, size in zip(state.effects, carried, strict=True) if size > NAMED * max(carried))


def memory_sets(survey: Survey, withheld: frozenset[str]) -> list[tuple[Effect, ...]]:
    """Return the sets of memories that are compared, none of them first."""
    ends = (survey.lowest, survey.highest)
    flat = ThermalLag(LAG_MIDDLE, *ends, centres=0.0, spread=2.0, poles=LAG_POLES)
    play = Hysteresis(PLAY_MIDDLE, spread=2.0, plays=PLAYS)
    sets: list[tuple[Effect, ...]] = [(), (play,)]
    for lag in (flat, *(replace(flat, centres=bends) for bends in BENDS)):
        sets += [(lag,), (lag, play)]
    return [one for one in sets if not any(effect.name in withheld for effect in one)]


def groups_of(problem: Problem, effects: tuple[Effect, ...]) -> tuple[int, ...]:
    """Return the groups of the columns of baseline and memories.

    Ṫ and T·ΔT are left out: they are what a lag of no length leaves, and would stand in for it.
    """
    count = len(problem.network.centres)
    groups = [STATIC] * count + [UNTIED, UNTIED, LEFT_OUT, LEFT_OUT] + [UNTIED] * problem.inputs.shape[1]
    for effect in effects:
        if isinstance(effect, ThermalLag):
            groups += ([LAG] + [LAG_MAP] * int(effect.centres)) * int(effect.poles)
        else:
            groups += [PLAY] * effect.count
    return tuple(groups)


def fit_spectra(problem: Problem, random: np.random.Generator, withheld: frozenset[str]) -> tuple[State, Spectra]:
    """Return the state with the chosen memories, and how they were chosen."""
    sets = memory_sets(problem.survey, withheld)
    # The noise is what the richest set leaves: what poorer ones leave beside it is structure.
    noise = State.of(problem, sets[-1])
    ahead = _sweep_back(problem)
    families = sorted((_family(noise, one, ahead) for one in sets), key=lambda f: -f.posterior.log_evidence)
    plain = next(f for f in families if not f.effects)
    left = problem.values - problem.baseline @ plain.posterior.weights
    static = float(np.sqrt(np.mean(left**2)))
    chosen = next(f for f in families if f.deviation < static or not f.effects)
    shares = _shares(chosen, [f for f in families if f.deviation < static and f.effects])
    priors = tuple((share, _groups_within(problem, chosen, family)) for share, family in shares)
    state = replace(noise.with_effects(chosen.effects, problem.columns(chosen.effects)), priors=priors)
    p_value = _p_value(noise, chosen, plain, random) if chosen.effects else 1.0
    return state, Spectra(tuple(families), chosen, shares, p_value, static)


LEAST_SHARE = 0.005


def _shares(chosen: Family, families: list[Family]) -> tuple[tuple[float, Family], ...]:
    """Return the chosen family and those that are parts of it, with their shares of the evidence."""
    parts = [f for f in families if f is chosen or all(_is_part(e, chosen.effects) for e in f.effects)]
    weights: list[float] = [float(np.exp(f.posterior.log_evidence - chosen.posterior.log_evidence)) for f in parts]
    kept = [(w, f) for w, f in zip(weights, parts, strict=True) if w > LEAST_SHARE]
    total = sum(w for w, _ in kept)
    return tuple((w / total, f) for w, f in kept)


def _is_part(effect: Effect, whole: tuple[Effect, ...]) -> bool:
    """Return whether the columns of an effect are among those of others: the same, or a lag without its bends."""
    straight = [replace(e, centres=0.0) for e in whole if isinstance(e, ThermalLag)]
    return effect in whole or effect in straight


def _groups_within(problem: Problem, chosen: Family, part: Family) -> tuple[int, ...]:
    """Return the groups of the chosen family's columns, those that a part of it lacks left out."""
    kinds = {LAG, LAG_MAP, PLAY} - set(part.groups)
    return tuple(LEFT_OUT if group in kinds else group for group in groups_of(problem, chosen.effects))


def _family(noise: State, effects: tuple[Effect, ...], ahead: tuple[Scene, Array]) -> Family:
    problem = noise.problem
    groups = groups_of(problem, effects)
    known = np.hstack([problem.baseline, *problem.columns(effects)])
    found = posterior(noise.whitener(known), noise.whitener(problem.values), groups)
    scene, baseline = ahead
    deviation = found.deviation(np.hstack([baseline, *scene.columns(effects)]))
    return Family(effects, groups, found, float(np.sqrt(np.mean(deviation**2))))


def _sweep_back(problem: Problem) -> tuple[Scene, Array]:
    """Return the last run driven back the way it came since its last turn, and the baseline's columns (n, k) there."""
    scene = problem.scene
    blocks, run = scene.blocks, scene.runs[int(scene.blocks.run[-1])]
    last = np.flatnonzero(blocks.run == blocks.run[-1])
    temperature = problem.features[last, 0]
    turn = last[int(np.argmin(temperature) if temperature[-1] > np.mean(temperature) else np.argmax(temperature))]
    end = int(blocks.stamps[last[-1]])
    sweep = np.arange(turn, last[-1] + 1)
    stamps = 2 * end - blocks.stamps[sweep][::-1]
    mirrored = replace(
        blocks,
        **{name: getattr(blocks, name)[sweep] for name in ("run", "values", "white", "first", "last")},
        stamps=stamps,
    )
    mirrored = replace(mirrored, run=np.zeros(len(sweep), dtype=np.int64))
    ahead = replace(
        scene, runs=(_driven_back(run, end),), blocks=mirrored, acceleration=(scene.acceleration[-1],),
        moving=scene.moving[sweep], carried=False,
    )  # fmt: skip
    return ahead, problem.baseline[sweep][::-1]


def _driven_back(run: Run, end: int) -> Run:
    smoothed = run.smoothed
    seen = smoothed.stamps <= end
    parts = [getattr(smoothed, name)[seen] for name in ("stamps", "temperature", "rate", "variance")]
    stamps, temperature, rate, variance = parts
    back = slice(-2, None, -1)
    joined = Smoothed(
        np.concatenate([stamps, 2 * stamps[-1] - stamps[back]]),
        np.concatenate([temperature, temperature[back]]),
        np.concatenate([rate, -rate[back]]),
        np.concatenate([variance, variance[back]]),
    )
    return replace(run, smoothed=joined, power_on=np.full(len(joined.stamps), run.power_on[0]))


def _p_value(noise: State, chosen: Family, plain: Family, random: np.random.Generator) -> float:
    """Return how often noise about a static map would gain as much evidence from these memories."""
    problem = noise.problem
    known = np.hstack([problem.baseline, *problem.columns(chosen.effects)])
    white, base = noise.whitener(known), noise.whitener(problem.baseline)
    gains = []
    for _ in range(SURROGATES):
        target = base @ plain.posterior.weights + random.standard_normal(len(base))
        with_, without = posterior(white, target, chosen.groups), posterior(base, target, plain.groups)
        gains.append(with_.log_evidence - without.log_evidence)
    place, scale = gumbel_r.fit(np.array(gains))
    return float(gumbel_r.sf(chosen.posterior.log_evidence - plain.posterior.log_evidence, place, scale))
