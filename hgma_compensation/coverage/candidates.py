"""What a diagnosis would try on a problem, and the noise that it would find there."""

import numpy as np

from hgma_compensation.diagnosis.forward import CLOSE
from hgma_compensation.diagnosis.lines import FEWEST_PERIODS, SHORTEST
from hgma_compensation.diagnosis.polish import answered, finding_form
from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.effects.registry import kinds

LINES = 8
"""Periods that stand for all: the search reads them off the spectrum instead of trying a grid."""


def state_of(problem: Problem) -> State:
    """Return the problem without an effect, under the noise beside whatever is in the recording already.

    Before that, the structure of an effect that the sensor has would count as noise, and hide all others.
    """
    state = State.of(problem, ())
    scored = [one for one in state.score(grid(problem)) if one.rank]
    if not scored:
        return state
    best = min(scored, key=lambda one: one.bic)
    if best.bic >= -CLOSE:
        return state
    found = answered(finding_form(best, problem.survey), state.score)
    return State.of(problem, (found.effect,)).with_effects((), ())


def grid(problem: Problem) -> list[Effect]:
    """Return all effects that a diagnosis of the problem would try, lines at a few periods."""
    effects = [effect for kind in kinds().values() for effect in kind.candidates(problem.survey)]
    shortest, longest = SHORTEST * problem.block, problem.survey.duration / FEWEST_PERIODS
    if longest > shortest:
        origin = float(problem.survey.origin)
        effects += [PeriodicInterference(float(p), origin) for p in np.geomspace(shortest, longest, LINES)]
    return effects
