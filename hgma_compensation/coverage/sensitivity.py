"""The smallest size of an effect that a diagnosis would name, computed on the recording that it would see.

An effect leaves, whitened and off what the drift model can carry, a vector k·u, |u| = 1. A form of an effect with
directions Q carries the share |Qᵀu|² of it, and its gain in the search is non-central χ² with λ = k²|Qᵀu|². The length
k asked for is that at which a form of the effect itself passes the diagnosis' own thresholds
(``diagnosis/forward.py``) nine times in ten, and no form of another kind comes within CLOSE of its BIC. An effect of a
measured input is counted by what that input has of its own (``diagnosis/own_motion.py``).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, ncx2

from hgma_compensation.coverage.candidates import grid, state_of
from hgma_compensation.coverage.shapes import shaped_by_drift
from hgma_compensation.diagnosis.baseline import independent
from hgma_compensation.diagnosis.forward import CLOSE, LARGEST_P, LEAST_CONTRIBUTION
from hgma_compensation.diagnosis.leftover import slow_directions
from hgma_compensation.diagnosis.lines import TRIALS
from hgma_compensation.diagnosis.own_motion import OwnMotion, needs_own_motion, own_motion
from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.diagnosis.result import reported_name
from hgma_compensation.diagnosis.search import SEEN, Scored, searched_count
from hgma_compensation.diagnosis.significance import NullMaxima, null_maxima
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.training.blocks import noise_of_means

Array = NDArray[np.float64]

OFTEN = 0.9
"""Share of recordings in which an effect of the size given passes the thresholds."""

MEASURED = 3.0
"""RMS of a column off the drift model over its own noise: an input below it shows the noise of its meter only."""

LENGTHS = np.geomspace(1.0, 3e3, 160)
"""Whitened lengths of effects that are tried, 5 % apart."""

HIGHEST_SCORE = 300.0


@dataclass(frozen=True)
class Point:
    """One effect with its parameters. size: that would be named, RMS about its mean, the channel's unit.

    form: of the effect that would be found, with more columns where that pays. values: (n,) of the effect at that size,
    at the blocks. rival: kind that looks most like it; correlation: of what no drift model carries of the two.
    """

    effect: Effect
    form: Effect
    size: float
    values: Array
    rival: str
    correlation: float


@dataclass(frozen=True)
class Sensitivity:
    """A state and the effects on it, scored. own: by index, of those that are judged by what their input has alone."""

    state: State
    scored: tuple[Scored, ...]
    null: NullMaxima
    own: Mapping[int, OwnMotion]

    @classmethod
    def of(cls, problem: Problem, random: np.random.Generator) -> "Sensitivity":
        """Return the sensitivity of a problem; the generator makes the surrogates of its noise."""
        state = state_of(problem)
        scored = state.score(grid(problem))
        smooth = [one.directions for one in scored if not isinstance(one.effect, PeriodicInterference)]
        null = null_maxima(state.projection, smooth, random)
        asked = [i for i, one in enumerate(scored) if one.rank and needs_own_motion(one.effect)]
        slow = slow_directions(state)
        own = {i: own_motion(state, scored[i], slow, random.spawn(1)[0]) for i in asked}
        return cls(state, tuple(scored), null, own)

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
        if not self.scored:
            return ()
        first = np.column_stack([one.columns[:, 0] for one in self.scored])
        shaped = first.copy()
        rich = shaped_by_drift(self.state, [one.effect for one in self.scored])
        for index, (_, column) in rich.items():
            shaped[:, index] = column
        forms = [_Form(number, one) for number, one in enumerate(self.scored) if one.rank]
        scored = self.state.score([form for form, _ in rich.values()])
        forms += [_Form(number, one) for number, one in zip(rich, scored, strict=True) if one.rank]
        straight, (off, plain) = self._off(first)[0], self._off(shaped)
        points = []
        for index, one in enumerate(self.scored):
            length, own = float(np.linalg.norm(off[:, index])), float(np.linalg.norm(straight[:, index]))
            if not one.rank or not length or (one.effect.needs and not _is_input(plain[:, index], shaped[:, index])):
                continue
            if index in self.own and not self.own[index].moves:
                continue
            found = self._needed(index, off[:, index] / length, forms)
            least = LEAST_CONTRIBUTION * self.noise / max(float(np.sqrt(np.mean(plain[:, index] ** 2))), 1e-300)
            if found is not None:
                values = shaped[:, index] * max(found[0] / length, least)
                rival, share = self._most_like(one, straight[:, index] / max(own, 1e-300))
                points.append(Point(one.effect, found[1], float(np.std(values)), values, rival, float(np.sqrt(share))))
        return tuple(points)

    def follows(self, kind: type[Effect]) -> bool:
        """Return whether what a kind answers to is measured, but never moves by itself."""
        return any(isinstance(self.scored[i].effect, kind) and not motion.moves for i, motion in self.own.items())

    def _off(self, columns: Array) -> tuple[Array, Array]:
        """Return columns (n, m) off what is known: whitened, 0 where nothing is left of them, and plain."""
        white, known = self.state.whitener(columns), self.state.projection.known
        left = white - known @ (known.T @ white)
        left[:, np.linalg.norm(left, axis=0) <= np.sqrt(SEEN) * np.linalg.norm(white, axis=0)] = 0.0
        basis = independent(self.state.problem.baseline)
        return left, columns - basis @ (basis.T @ columns)

    def _needed(self, index: int, unit: Array, forms: Sequence["_Form"]) -> tuple[float, Effect] | None:
        """Return the length that an effect along a whitened unit vector (n,) needs to be named, and the form found.

        None where no length is enough. index: of the effect among those scored.
        """
        energy, cost = LENGTHS**2, np.log(len(unit))
        name = reported_name(self.scored[index].effect)
        own, rivals = [], np.full(len(LENGTHS), np.inf)
        for form in forms:
            same = reported_name(form.scored.effect) == name
            if same and form.index != index:
                continue
            share = _share(form.scored, unit)
            bic = -share * energy + (form.scored.rank + searched_count(form.scored.effect)) * cost
            if same:
                taken = self._taken(form.scored, share, 1.0 - share, energy)
                if form.index in self.own:
                    alone = self.own[form.index].scored
                    taken &= self._taken(alone, _share(alone, unit), 1.0 - share, energy)
                own.append((form.scored, np.where(taken, bic, np.inf)))
            else:
                rivals = np.minimum(rivals, bic)
        best = np.min([bic for _, bic in own], axis=0)
        enough = np.flatnonzero(np.isfinite(best) & (best < np.minimum(rivals, 0.0) - CLOSE))
        if not len(enough):
            return None
        place = int(enough[0])
        scored, _ = min(own, key=lambda pair: float(pair[1][place]))
        return float(LENGTHS[place]), scored.effect

    def _taken(self, form: Scored, share: float, missed: float, energy: Array) -> NDArray[np.bool_]:
        """Return for energies (m,) of an effect, of which a form carries a share, whether it is taken and kept OFTEN.

        The share missed by all that is known then raises the dispersion that significance is counted over
        (``leftover.py``).
        """
        line = isinstance(form.effect, PeriodicInterference)
        needed = np.log10(TRIALS / LARGEST_P) if line else self.score_needed
        dispersion = 1.0 + missed * energy / max(self.slow, 1)
        kept = CLOSE + (form.rank + searched_count(form.effect)) * np.log(len(self.state.problem.values))
        gain = np.maximum(chi2.isf(10.0**-needed, form.rank) * dispersion, kept)
        return np.asarray(ncx2.sf(gain, form.rank, np.maximum(share * energy, 1e-9)) >= OFTEN)

    @cached_property
    def slow(self) -> int:
        """Degrees of freedom of slow change that the drift model does not carry."""
        return int(slow_directions(self.state).shape[1])

    def _most_like(self, one: Scored, unit: Array) -> tuple[str, float]:
        """Return the kind of another name that carries most of a whitened unit vector (n,), and the share."""
        own, best, largest = reported_name(one.effect), "", 0.0
        for other in self.scored:
            if other.rank and reported_name(other.effect) != own:
                share = float(np.sum((other.directions.T @ unit) ** 2))
                if share > largest:
                    best, largest = other.name, min(share, 1.0)
        return best, largest


@dataclass(frozen=True)
class _Form:
    """A form of the effect of an index among those scored."""

    index: int
    scored: Scored


def _share(scored: Scored, unit: Array) -> float:
    """Return the share of a whitened unit vector (n,) that a form carries."""
    return min(float(np.sum((scored.directions.T @ unit) ** 2)), 1.0)


def _is_input(off: Array, column: Array) -> bool:
    """Return whether a measured input (n,) moves by more than its own noise; off: (n,) off the drift model."""
    return float(np.std(off)) > MEASURED * noise_of_means(column)


def fraction(points: Sequence[Point], size: float) -> float:
    """Return the share of points that need no more than a size."""
    return sum(point.size <= size for point in points) / len(points) if points else 0.0
