"""Effects of every kind that there is, with parameters at the ends of their spans, on them and beyond."""

import copy
import json
import math
import random
from dataclasses import fields
from typing import Any

from benchmarks.soak.fuzz.tree_mutations import number
from hgma_compensation.channels import CHANNELS
from hgma_compensation.effects.effect import Effect, Span
from hgma_compensation.effects.registry import kinds
from hgma_compensation.errors import RefusedError

MOST_GAINS = 20


def mutate(document: dict[str, Any], chance: random.Random) -> None:
    """Give a document one to three more effects, or others in their place."""
    calibrated = [name for name in CHANNELS if name in json.dumps(document.get("channels"))]
    made = [_effect(chance.choice(calibrated or list(CHANNELS)), chance) for _ in range(chance.randrange(1, 4))]
    if chance.random() < 0.1:
        made = [copy.deepcopy(made[0]) for _ in range(chance.choice((9, 64, 65)))]
    kept = document.get("effects", [])
    document["effects"] = made + (kept if isinstance(kept, list) and chance.random() < 0.5 else [])


def _effect(channel: str, chance: random.Random) -> dict[str, Any]:
    kind = chance.choice(list(kinds().values()))
    parameters: dict[str, Any] = {
        field.name: _parameter(kind.spans[field.name], chance) if field.name in kind.spans else channel
        for field in fields(kind)  # type: ignore[arg-type]
    }
    if "source" in parameters:
        parameters["source"] = chance.choice(CHANNELS)
    count = _count(kind, parameters) if chance.random() < 0.97 else chance.randrange(MOST_GAINS)
    size = 10.0 ** chance.uniform(-15.0, 13.0)
    gains = [number(chance) if chance.random() < 0.05 else chance.gauss(0.0, size) for _ in range(count)]
    return {"effect": kind.name, "channel": channel, "parameters": parameters, "gains": gains}


def _parameter(span: Span, chance: random.Random) -> float:
    low, high = span.lower, span.upper
    inside = chance.uniform(low, high)
    ends = (low, high, float(math.floor(inside)), inside)
    beyond = (math.nextafter(high, math.inf), math.nextafter(low, -math.inf), number(chance))
    return chance.choice(ends) if chance.random() < 0.95 else chance.choice(beyond)


def _count(kind: type[Effect], parameters: dict[str, Any]) -> int:
    """Return the number of gains that an effect takes; any where the parameters make none."""
    effect = kind(**parameters)
    try:
        effect.check()
        return min(effect.count, 64)
    except (RefusedError, ValueError, OverflowError):
        return 1
