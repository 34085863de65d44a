"""Effects that recordings could not tell apart."""

from collections.abc import Sequence

import numpy as np

from hgma_compensation.coverage.result import LookAlike
from hgma_compensation.coverage.sensitivity import Point
from hgma_compensation.diagnosis.result import reported_name
from hgma_compensation.effects.registry import kinds

ALIKE = 0.95
"""Correlation of what no drift model carries of two effects, beyond which they are not told apart."""


def look_alikes(points: Sequence[Point], effects: Sequence[str]) -> tuple[LookAlike, ...]:
    """Return the kinds of which at least half of the parameters tried look like another kind, most alike first.

    effects: names of kinds, of which one at least must be in a pair.
    """
    wanted = {reported_name_of(name) for name in effects}
    found: dict[frozenset[str], float] = {}
    names = sorted({reported_name(point.effect) for point in points})
    for name in names:
        own = [point for point in points if reported_name(point.effect) == name]
        for rival in {point.rival for point in own if point.rival}:
            alike = [point.correlation for point in own if point.rival == rival and point.correlation > ALIKE]
            pair = frozenset((name, reported_name_of(rival)))
            if 2 * len(alike) >= len(own) and pair & wanted:
                found[pair] = max(found.get(pair, 0.0), float(np.median(alike)))
    return tuple(
        LookAlike(min(pair), max(pair), correlation)
        for pair, correlation in sorted(found.items(), key=lambda item: -item[1])
    )


def reported_name_of(name: str) -> str:
    """Return the name under which a diagnosis reports a kind."""
    return kinds()[name].family or name
