"""Finds the parameters of effects between the points of their grids: variable projection over one number each.

A search is a generator that asks for effects to be scored and is sent the answers. Searches that wait for nothing of
each other can thus go side by side: memories then move through the recordings once for all that they ask in a round.
"""

from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from itertools import islice
from typing import TypeAlias, TypeVar

import numpy as np

from hgma_compensation.diagnosis.search import Scored
from hgma_compensation.effects.effect import Effect, Survey

Result = TypeVar("Result")
Score = Callable[[Sequence[Effect]], list[Scored]]
Search: TypeAlias = Generator[list[Effect], list[Scored], Result]

ROUNDS = 6
POINTS = (-1.0, -0.5, 0.5, 1.0)

RICHER = 6.0
"""Fall of the BIC that a form with more columns must bring."""


def searched_parameter(effect: Effect) -> str | None:
    """Return the name of the parameter that is looked for, None where there is none."""
    return next((name for name, span in effect.spans.items() if span.searched), None)


def polish(start: Scored, score: Score, survey: Survey) -> Scored:
    """Return the best effect near a start, by halving steps around the best so far."""
    return answered(polishing(start, survey), score)


def polishing(start: Scored, survey: Survey) -> Search[Scored]:
    """Search the best effect near a start, by halving steps around the best so far."""
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
        scored = yield [one for one in effects if one.inside(survey)]
        best = min([best, *scored], key=lambda s: s.bic)
        step *= 0.5
    return best


def finding_form(start: Scored, survey: Survey) -> Search[Scored]:
    """Search the best effect near a start, then its forms with more columns; one must be RICHER better."""
    best = yield from polishing(start, survey)
    forms = yield list(best.effect.richer(survey))
    for rich in (yield from side_by_side([polishing(form, survey) for form in forms])):
        if rich.bic < best.bic - RICHER:
            best = rich
    return best


def side_by_side(searches: Sequence[Search[Result]]) -> Search[list[Result]]:
    """Search all at once: what they ask is asked together, each is sent its own answers."""
    results: dict[int, Result] = {}
    asked: dict[int, list[Effect]] = {}

    def go_on(number: int, answers: list[Scored] | None) -> None:
        try:
            asked[number] = next(searches[number]) if answers is None else searches[number].send(answers)
        except StopIteration as end:
            asked.pop(number, None)
            results[number] = end.value

    for number in range(len(searches)):
        go_on(number, None)
    while asked:
        answers = iter((yield [effect for effects in asked.values() for effect in effects]))
        for number, effects in list(asked.items()):
            go_on(number, list(islice(answers, len(effects))))
    return [results[number] for number in range(len(searches))]


def answered(search: Search[Result], score: Score) -> Result:
    """Return what a search finds, its questions answered by ``score``."""
    try:
        asked = next(search)
        while True:
            asked = search.send(score(asked))
    except StopIteration as end:
        result: Result = end.value
        return result


def _with(effect: Effect, name: str, value: float) -> Effect:
    """Return the effect with another value of a parameter."""
    changed: Effect = replace(effect, **{name: value})  # type: ignore[type-var]
    return changed
