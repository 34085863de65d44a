"""The search for effects: one after the other, each with the chance to replace those before it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.baseline import independent
from hgma_compensation.diagnosis.cross_validation import folds_for, share_of_folds
from hgma_compensation.diagnosis.leftover import leftover, slow_directions
from hgma_compensation.diagnosis.lines import TRIALS, line_candidates
from hgma_compensation.diagnosis.own_motion import needs_own_motion, own_motion
from hgma_compensation.diagnosis.polish import answered, finding_form, side_by_side
from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.diagnosis.search import Scored
from hgma_compensation.diagnosis.significance import null_maxima, score_of
from hgma_compensation.diagnosis.spectra import Spectra
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.effects.registry import kinds
from hgma_compensation.kept_memory import give_back

Array = NDArray[np.float64]

LINE = PeriodicInterference.name

MOST_EFFECTS = 4
LARGEST_P = 0.002
SERIOUS = 0.5
"""Kinds whose best gain on the grid reaches this share of the best one's are polished before they are compared."""

LEAST_FOLDS = 2.0 / 3.0
LEAST_CONTRIBUTION = 0.25
"""RMS of an effect's part that no drift model could carry, over the noise of a mean of 10 s."""

LEAST_SHARE = 0.12
"""The same over that of the largest effect: less is more likely its own law, which is never quite the fitted one."""

CLOSE = 10.0
"""BIC within which two explanations cannot be told apart (Kass and Raftery 1995)."""

FOLLOWS = "what it answers to moves only as the temperature and its rate make it"
STANDS_ALONE = "does not follow what it answers to where that moves by itself"


@dataclass(frozen=True)
class Candidate:
    """The best of a kind at one stage. reason: why it was not taken, "" where it was or could be."""

    scored: Scored
    p_value: float
    folds: float = 0.0
    contribution: float = 0.0
    reason: str = ""

    @property
    def undecided(self) -> bool:
        """Whether it fits, but the data could not tell it from what it is confused with."""
        return self.reason == FOLLOWS


@dataclass(frozen=True)
class Found:
    """An accepted effect: p-value when it was taken, and the kinds within CLOSE of it, with their BIC over its own.

    contribution: RMS of what no drift model could carry of it, over the noise of a mean of 10 s. undecided: kinds that
    carry as much or more, but whose input showed nothing of its own.
    """

    effect: Effect
    p_value: float
    contribution: float
    runners_up: dict[str, float] = field(default_factory=dict)
    undecided: tuple[str, ...] = ()


@dataclass(frozen=True)
class Findings:
    """State with all that was found; the stages' candidates, best first; or the spectra where data are scarce."""

    before: State
    state: State
    found: tuple[Found, ...]
    stages: tuple[tuple[Candidate, ...], ...]
    spectra: Spectra | None = None

    @property
    def undecided(self) -> tuple[str, ...]:
        """Names of kinds that would fit what is left, but could not be told from what they are confused with."""
        return tuple(c.scored.name for c in (self.stages[-1] if self.stages else ()) if c.undecided)

    def put_away(self) -> None:
        """Keep of what the search held in memory that which the evidence is drawn from, covariances in files."""
        for state in (self.before, self.state):
            state.whitener.put_away()
            state.problem.forget(state.effects)


Progress = Callable[[str], None]


@dataclass
class Forward:
    """The search on one problem. withheld: names of kinds that are not tried."""

    problem: Problem
    random: np.random.Generator
    withheld: frozenset[str] = frozenset()
    progress: Progress | None = None

    def run(self) -> Findings:
        """Return what was found."""
        before = state = State.of(self.problem, ())
        found: list[Found] = []
        stages: list[tuple[Candidate, ...]] = []
        while len(found) < MOST_EFFECTS:
            self._say(f"effect {len(found) + 1}")
            state, candidates = self._stage(state, max((f.contribution for f in found), default=0.0))
            # Their columns are not needed beside the covariances that follow.
            candidates = [replace(one, scored=one.scored.figures()) for one in candidates]
            stages.append(tuple(candidates))
            chosen = next((c for c in candidates if not c.reason), None)
            if chosen is None:
                break
            close = {
                c.scored.name: c.scored.bic - chosen.scored.bic
                for c in candidates
                if c is not chosen and abs(c.scored.bic - chosen.scored.bic) <= CLOSE
            }
            undecided = [c.scored.name for c in candidates if c.undecided and c.scored.bic <= chosen.scored.bic + CLOSE]
            found.append(Found(chosen.scored.effect, chosen.p_value, chosen.contribution, close, tuple(undecided)))
            self._carry(state, found)
            state, found = self._refine(state, found)
        state.whitener.put_away()
        return Findings(before, State.of(self.problem, [f.effect for f in found]), tuple(found), tuple(stages))

    def _say(self, text: str) -> None:
        if self.progress is not None:
            self.progress(text)

    # One stage ----------------------------------------------------------------------------------------

    def _grid(self, state: State) -> list[Effect]:
        taken = {effect.name for effect in state.effects}
        grid = [
            effect
            for name, kind in kinds().items()
            if name not in self.withheld and name not in taken
            for effect in kind.candidates(self.problem.survey)
        ]
        if LINE not in self.withheld:
            grid += line_candidates(state)
        return grid

    def _stage(self, state: State, largest: float) -> tuple[State, list[Candidate]]:
        """Return the state under the noise beside the best candidate, and the candidates, best first."""
        grid = self._grid(state)
        scored = state.score(grid)
        best = self._polished(state, scored)
        if best:
            # Under the noise that is left beside the best candidate: before, its own structure counts as noise.
            strongest = best[0].effect
            state.whitener.put_away()
            del scored, best  # and what they hold, while the covariance is formed
            noise = State.of(self.problem, (*state.effects, strongest))
            state = noise.with_effects(state.effects, state.columns)
            scored = state.score(grid)
            best = self._polished(state, scored)
        smooth = [s for s in scored if s.name != LINE]
        null = null_maxima(state.projection, [s.directions for s in smooth], self.random)
        del scored, smooth
        give_back()
        slow = slow_directions(state)
        return state, [self._judged(state, slow, scored, null.p_value, largest) for scored in best]

    def _polished(self, state: State, scored: Sequence[Scored]) -> list[Scored]:
        """Return the best of each kind, sorted by BIC, those that could win with their parameter polished."""
        best: dict[str, Scored] = {}
        for one in scored:
            if one.rank and (one.name not in best or one.bic < best[one.name].bic):
                best[one.name] = one
        if not best:
            return []
        top = max(one.gain for one in best.values())
        serious = [name for name, one in best.items() if one.gain >= SERIOUS * top and one.gain > 10.0]
        searches = [finding_form(best[name], self.problem.survey) for name in serious]
        best.update(zip(serious, answered(side_by_side(searches), state.score), strict=True))
        return sorted(best.values(), key=lambda s: s.bic)

    def _judged(
        self, state: State, slow: Array, scored: Scored, p_value: Callable[[float], float], largest: float
    ) -> Candidate:
        dispersion = leftover(state.projection.added(scored.columns), slow).dispersion
        score = float(score_of(scored.gain, scored.rank, dispersion))
        p = min(1.0, TRIALS * 10.0**-score) if scored.name == LINE else p_value(score)
        candidate = Candidate(scored, p)
        if p > LARGEST_P:
            return replace(candidate, reason="noise alone does as well")
        share, fall = share_of_folds(state, scored.columns, folds_for(state, scored.effect))
        candidate = replace(candidate, folds=share, contribution=self._contribution(state, scored))
        if share < LEAST_FOLDS - 1e-9 or fall <= 0.0:
            return replace(candidate, reason="does not predict data that it was not fitted to")
        if candidate.contribution < LEAST_CONTRIBUTION:
            return replace(candidate, reason="too small to matter")
        if candidate.contribution < LEAST_SHARE * largest:
            return replace(candidate, reason="too small beside the effect found")
        return replace(candidate, reason=self._not_by_itself(state, slow, scored, p_value))

    def _not_by_itself(self, state: State, slow: Array, scored: Scored, p_value: Callable[[float], float]) -> str:
        """Return why an effect of a measured input is not shown by what the input has of its own, "" where it is."""
        if not needs_own_motion(scored.effect):
            return ""
        motion = own_motion(state, scored, slow, self.random.spawn(1)[0])
        if not motion.moves:
            return FOLLOWS
        score = float(score_of(motion.gain, motion.scored.rank, motion.left.dispersion))
        return STANDS_ALONE if p_value(score) > LARGEST_P else ""

    def _contribution(self, state: State, scored: Scored) -> float:
        """Return the RMS of the effect off the baseline over the noise of a mean of 10 s."""
        weights, _ = state.with_effects([*state.effects, scored.effect], [*state.columns, scored.columns]).fit()
        added = scored.columns @ weights[-scored.columns.shape[1] :]
        basis = independent(self.problem.baseline)
        noise = np.sqrt(np.median(state.noise.white) * self.problem.block / 10.0)
        return float(np.sqrt(np.mean((added - basis @ (basis.T @ added)) ** 2)) / noise)

    # After an effect was taken -------------------------------------------------------------------------

    def _carry(self, state: State, found: Sequence[Found]) -> None:
        """Let memories go on from run to run where that explains the data better than a new beginning in each.

        A sensor that lay still between recordings remembers; recordings put together from different lives do not.
        """
        effects = [f.effect for f in found]
        if self.problem.scene.carried or all(e.memory() is None for e in effects):
            return
        carried = replace(self.problem, scene=replace(self.problem.scene, carried=True), cache={})
        left = [state.with_effects(effects, problem.columns(effects)).left for problem in (self.problem, carried)]
        if left[1] < left[0] - CLOSE:
            self.problem = carried

    def _refine(self, state: State, found: list[Found]) -> tuple[State, list[Found]]:
        """Refit the noise, polish effects beside each other, replace those that another kind beats, drop idle ones."""
        for _ in range(2):
            state.whitener.put_away()
            state = State.of(self.problem, [f.effect for f in found])
            for index in range(len(found)):
                found[index] = self._replaced(state, found, index)
                state = self._beside(state, found)
        largest = max(f.contribution for f in found)
        kept = [
            f for i, f in enumerate(found) if f.contribution >= LEAST_SHARE * largest and self._needed(state, found, i)
        ]
        state.whitener.put_away()
        return State.of(self.problem, [f.effect for f in kept]), kept

    def _beside(self, state: State, found: Sequence[Found]) -> State:
        effects = [f.effect for f in found]
        return state.with_effects(effects, self.problem.columns(effects))

    def _replaced(self, state: State, found: list[Found], index: int) -> Found:
        """Return the effect polished beside the others, or another kind that does better in its place."""
        own = found[index]
        others = self._beside(state, [f for i, f in enumerate(found) if i != index])
        current = answered(finding_form(others.score([own.effect])[0], self.problem.survey), others.score)
        if len(found) == 1:
            return replace(own, effect=current.effect, contribution=self._contribution(others, current))
        rivals = [s for s in self._polished(others, others.score(self._grid(others))) if s.name != own.effect.name]
        close = {s.name: s.bic - current.bic for s in rivals if abs(s.bic - current.bic) <= CLOSE}
        better = [s for s in rivals if s.bic < current.bic - CLOSE / 5.0]
        new = next((s for s in better if self._moves(others, s)), None)
        if new is not None:
            close = {s.name: s.bic - new.bic for s in rivals if s is not new and abs(s.bic - new.bic) <= CLOSE}
            return Found(new.effect, own.p_value, self._contribution(others, new), close, own.undecided)
        return replace(own, effect=current.effect, contribution=self._contribution(others, current), runners_up=close)

    def _moves(self, state: State, scored: Scored) -> bool:
        """Return whether an effect is there by what its input has of its own, as far as that is asked of it."""
        if not needs_own_motion(scored.effect):
            return True
        motion = own_motion(state, scored, slow_directions(state), self.random.spawn(1)[0])
        return motion.moves and motion.gain > CLOSE + motion.scored.rank * float(np.log(len(self.problem.values)))

    def _needed(self, state: State, found: Sequence[Found], index: int) -> bool:
        others = self._beside(state, [f for i, f in enumerate(found) if i != index])
        return others.score([found[index].effect])[0].bic < -CLOSE
