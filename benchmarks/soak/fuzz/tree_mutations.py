"""Changes of a document's tree: values, lengths, fields, and whole parts of other documents."""

import copy
import math
import random
from typing import Any

NUMBERS = (
    *(0, -0.0, 1, -1, 2, 3, 60, 100, 250, -100, 86400, 5e-324, 1e-300, 1e-31, 1e-30, 1e-20, 1e-15, 1e-12, 1e-9, 1e6),
    *(1e7, 1e9, 1e12, math.nextafter(1e12, math.inf), 1e15, 1e30, 1e154, 1e200, 1e300, 1.7976931348623157e308, -300),
    *(2000, 2001, 2**31, 2**53 + 1, 2**63, 2**64, 10**308, 9.2e18, 0.5, 1e-6, math.nan, math.inf, 10**400),
)
TEXTS = (
    *("", "x", "\x00", "\ud800", "\n", "\x1b[2J", "\u202e", "\xa0", "x" * 201, "x" * 1001, "z", "rbf", "polynomial"),
    *("linear_acceleration.z", "angular_velocity.x", "smooth", "bias", "off", "delay", "reference", "hysteresis"),
)
OTHERS: tuple[Any, ...] = (None, True, False, [], {}, [[]], [0.0, 0.0, 0.0], {"mode": "off"})
Slot = tuple[Any, Any]
"""A container and the key or index in it."""


def slots(document: Any) -> list[Slot]:
    """Return every place in a document that holds a value."""
    found: list[Slot] = []
    stack = [document]
    while stack:
        container = stack.pop()
        keys = container if isinstance(container, dict) else range(len(container))
        for key in keys:
            found.append((container, key))
            if isinstance(container[key], (dict, list)):
                stack.append(container[key])
    return found


def mutate(document: Any, other: Any, chance: random.Random) -> None:
    """Change a document in one to four places; other: one to take parts from."""
    for _ in range(min(1 + int(chance.expovariate(1.2)), 4)):
        if places := slots(document):
            container, key = chance.choice(places)
            chance.choices(_CHANGES, _WEIGHTS)[0](container, key, other, chance)


def number(chance: random.Random) -> float:
    """Return a number that is special, or of any magnitude."""
    if chance.random() < 0.5:
        return chance.choice((1, -1)) * chance.choice(NUMBERS)
    return chance.choice((1, -1)) * 10.0 ** chance.uniform(-40.0, 40.0)


def _perturb(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    value = container[key]
    if isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300:
        factor = chance.choice((-1.0, 1.0 + 1e-9, 0.5, 10.0, 1e-3, 1e6, 1e-9, 10.0 ** chance.uniform(-20, 20)))
        container[key] = value * factor
    elif isinstance(value, str):
        at = chance.randrange(len(value) + 1)
        container[key] = value[:at] + chance.choice(TEXTS) + value[at + 1 :]


def _set_number(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    container[key] = number(chance)


def _set_other(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    container[key] = copy.deepcopy(chance.choice(TEXTS + OTHERS))


def _wrap(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    for _ in range(chance.choice((1, 2, 30, 33, 200))):
        container[key] = [container[key]]


def _remove(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    del container[key]


def _rename(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    if isinstance(container, dict):
        container[chance.choice((*TEXTS, key.upper(), key + "_", "effects", "gains"))] = container.pop(key)


def _add(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    value = copy.deepcopy(container[key])
    if isinstance(container, dict):
        container[chance.choice(TEXTS) or key + "2"] = value
    else:
        container[key:key] = [value] * chance.choice((1, 1, 2, 64, 100, 501))


def _graft(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    places = slots(other)
    alike = [(place, name) for place, name in places if name == key]
    place, name = chance.choice(alike if alike and chance.random() < 0.8 else places)
    container[key] = copy.deepcopy(place[name])


def _swap(container: Any, key: Any, other: Any, chance: random.Random) -> None:
    second = chance.choice(list(container) if isinstance(container, dict) else range(len(container)))
    container[key], container[second] = container[second], container[key]


_CHANGES = (_perturb, _set_number, _set_other, _wrap, _remove, _rename, _add, _graft, _swap)
_WEIGHTS = (6.0, 6.0, 1.0, 0.3, 1.0, 0.5, 1.0, 3.0, 1.0)
