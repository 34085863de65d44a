"""The smallest size of an effect that a diagnosis would name, computed on the recording that it would see.

An effect with one gain k on its first column c leaves, whitened and off what the drift model can carry, k·u with
|u| known; its gain in the search is then non-central χ² with λ = k²|u|², and the size asked for is the k at which the
gain passes the diagnosis' own thresholds nine times in ten (``diagnosis/forward.py``). Another kind with directions Q
takes the share ρ² = |Qᵀu|²/|u|² of that gain, so that (1 − ρ²)·λ decides between the two.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import chi2, ncx2

from hgma_compensation.diagnosis.baseline import independent
from hgma_compensation.diagnosis.forward import CLOSE, LARGEST_P, LEAST_CONTRIBUTION
from hgma_compensation.diagnosis.lines import FEWEST_PERIODS, SHORTEST, TRIALS
from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.diagnosis.result import reported_name
from hgma_compensation.diagnosis.search import SEEN, Scored, searched_count
from hgma_compensation.diagnosis.significance import NullMaxima, null_maxima
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.effects.registry import kinds
from hgma_compensation.training.blocks import noise_of_means

Array = NDArray[np.float64]

OFTEN = 0.9
"""Share of recordings in which an effect of the size given passes the thresholds."""

LINES = 8
"""Periods that stand for all: the search reads them off the spectrum instead of trying a grid."""

MEASURED = 3.0
"""RMS of a column off the drift model over its own noise: an input below it shows the noise of its meter only."""

HIGHEST_SCORE = 300.0


@dataclass(frozen=True)
class Point:
    """One effect with its parameters. size: that would be named, between its extremes, the channel's unit.

    gain: of the first column, at that size. rival: kind that takes the largest share of it; correlation: ρ.
    """

    effect: Effect
    size: float
    gain: float
    rival: str
    correlation: float


def state_of(problem: Problem) -> State:
    """Return the problem without an effect, under the noise beside whatever is in the recording already.

    Before that, the structure of an effect that the sensor has would count as noise, and hide all others.
    """
    state = State.of(problem, ())
    scored = [one for one in state.score(grid(problem)) if one.rank]
    if not scored:
        return state
    best = min(scored, key=lambda one: one.bic)
    return State.of(problem, (best.effect,)).with_effects((), ()) if best.bic < -CLOSE else state


def grid(problem: Problem) -> list[Effect]:
    """Return all effects that a diagnosis of the problem would try, lines at a few periods."""
    effects = [effect for kind in kinds().values() for effect in kind.candidates(problem.survey)]
    shortest, longest = SHORTEST * problem.block, problem.survey.duration / FEWEST_PERIODS
    if longest > shortest:
        origin = float(problem.survey.origin)
        effects += [PeriodicInterference(float(p), origin) for p in np.geomspace(shortest, longest, LINES)]
    return effects


@dataclass(frozen=True)
class Sensitivity:
    """A state and the effects on it, scored."""

    state: State
    scored: tuple[Scored, ...]
    null: NullMaxima

    @classmethod
    def of(cls, problem: Problem, random: np.random.Generator) -> "Sensitivity":
        """Return the sensitivity of a problem; the generator makes the surrogates of its noise."""
        state = state_of(problem)
        scored = state.score(grid(problem))
        smooth = [one.directions for one in scored if not isinstance(one.effect, PeriodicInterference)]
        return cls(state, tuple(scored), null_maxima(state.projection, smooth, random))

    @cached_property
    def noise(self) -> float:
        """White noise of a mean of 10 s, in the channel's unit."""
        return float(np.sqrt(np.median(self.state.noise.white) * self.state.problem.block / 10.0))

    @cached_property
    def score_needed(self) -> float:
        """Smallest score that is significant over all that is tried."""
        low, high = 0.0, HIGHEST_SCORE
        while high - low > 0.01:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self.null.p_value(middle) <= LARGEST_P else (middle, high)
        return high

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """The effects that leave something off the drift model, each with the size that would be named."""
        first = [_first(one) for one in self.scored]
        off, plain = self._off(np.column_stack(first)) if first else (np.empty((0, 0)), np.empty((0, 0)))
        points = []
        for index, (one, column) in enumerate(zip(self.scored, first, strict=True)):
            length = float(np.linalg.norm(off[:, index]))
            if not one.rank or not length or (one.effect.needs and not _is_input(plain[:, index], column)):
                continue
            rival, share = self._rival(one, off[:, index] / length)
            gain = max(
                np.sqrt(self._energy(one)) / length,
                np.sqrt(CLOSE / max(1.0 - share, 1e-12)) / length,
                LEAST_CONTRIBUTION * self.noise / max(float(np.sqrt(np.mean(plain[:, index] ** 2))), 1e-300),
            )
            points.append(Point(one.effect, gain * float(np.ptp(column)), gain, rival, float(np.sqrt(share))))
        return tuple(points)

    def _off(self, columns: Array) -> tuple[Array, Array]:
        """Return columns (n, m) off what is known: whitened, 0 where nothing is left of them, and plain."""
        white, known = self.state.whitener(columns), self.state.projection.known
        left = white - known @ (known.T @ white)
        left[:, np.linalg.norm(left, axis=0) <= np.sqrt(SEEN) * np.linalg.norm(white, axis=0)] = 0.0
        basis = independent(self.state.problem.baseline)
        return left, columns - basis @ (basis.T @ columns)

    def _energy(self, one: Scored) -> float:
        """Return the λ at which the effect is taken OFTEN, and is kept: its BIC then is below −CLOSE."""
        line = isinstance(one.effect, PeriodicInterference)
        needed = np.log10(TRIALS / LARGEST_P) if line else self.score_needed
        kept = CLOSE + (one.rank + searched_count(one.effect)) * np.log(len(self.state.problem.values))
        gain = max(float(chi2.isf(10.0**-needed, one.rank)), kept)
        return float(brentq(lambda energy: ncx2.sf(gain, one.rank, energy) - OFTEN, 1e-3, 100.0 * gain))

    def _rival(self, one: Scored, unit: Array) -> tuple[str, float]:
        """Return the kind of another name that takes the largest share of a whitened unit vector (n,), and the share.

        A direction that both own columns and the rival's span is none that decides: those of the other columns of the
        effect itself are left in.
        """
        own, best, largest = reported_name(one.effect), "", 0.0
        for other in self.scored:
            if other.rank and reported_name(other.effect) != own:
                share = float(np.sum((other.directions.T @ unit) ** 2))
                if share > largest:
                    best, largest = other.name, min(share, 1.0)
        return best, largest


def _first(one: Scored) -> Array:
    """Return the effect's first column (n,), the plain one where others bend with the temperature."""
    return one.columns[:, 0]


def _is_input(off: Array, column: Array) -> bool:
    """Return whether a measured input (n,) moves by more than its own noise; off: (n,) off the drift model."""
    return float(np.std(off)) > MEASURED * noise_of_means(column)


def fraction(points: Sequence[Point], size: float) -> float:
    """Return the share of points that need no more than a size."""
    return sum(point.size <= size for point in points) / len(points) if points else 0.0
