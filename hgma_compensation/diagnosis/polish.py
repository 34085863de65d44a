"""Finds the parameter of an effect between the points of its grid: variable projection over one number."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from hgma_compensation.diagnosis.search import Scored
from hgma_compensation.effects.effect import Effect, Survey

Score = Callable[[Sequence[Effect]], list[Scored]]

ROUNDS = 6
POINTS = (-1.0, -0.5, 0.5, 1.0)


def searched_parameter(effect: Effect) -> str | None:
    """Return the name of the parameter that is looked for, None where there is none."""
    return next((name for name, span in effect.spans.items() if span.searched), None)


def polish(start: Scored, score: Score, survey: Survey) -> Scored:
    """Return the best effect near a start, by halving steps around the best so far."""
    name = searched_parameter(start.effect)
    if name is None:
        return start
    span = start.effect.spans[name]
    logarithmic = span.lower > 0.0
    best, step = start, start.effect.search_step(survey)
    for _ in range(ROUNDS):
        value = getattr(best.effect, name)
        tried = [value * np.exp(step * p) if logarithmic else value + step * p for p in POINTS]
        inside = [float(v) for v in tried if span.lower <= v <= span.upper]
        effects = [_with(best.effect, name, v) for v in inside]
        best = min([best, *score([one for one in effects if one.inside(survey)])], key=lambda s: s.bic)
        step *= 0.5
    return best


def _with(effect: Effect, name: str, value: float) -> Effect:
    """Return the effect with another value of a parameter."""
    changed: Effect = replace(effect, **{name: value})  # type: ignore[type-var]
    return changed
