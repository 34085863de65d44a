"""Makes documents: from seeds, by their bytes, their tree or their effects, with the id of the content or without."""

import json
import random
from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar

from benchmarks.soak.fuzz import effect_mutations, text_mutations, tree_mutations
from benchmarks.soak.fuzz.oracle import content_id

MOST_SEEDS, LARGEST_SEED = 600, 6_000


class Class(str, Enum):
    """How a document was made; HARMLESS ones must be accepted."""

    TEXT = "text"
    TREE = "tree"
    EFFECTS = "effects"
    HARMLESS = "harmless"


@dataclass(frozen=True)
class Mutant:
    """A document and how it was made."""

    content: bytes
    kind: Class


@dataclass(frozen=True)
class Seeds:
    """Documents to begin with, all of them JSON objects; accepted: at least one that every parser must accept."""

    accepted: list[bytes]
    refused: list[bytes]


class Mutator:
    """Endless documents of one random generator; what was new is taken as a seed for more."""

    SHARES: ClassVar[dict[Class, float]] = {Class.TEXT: 0.2, Class.TREE: 0.48, Class.EFFECTS: 0.3, Class.HARMLESS: 0.02}
    WITH_ID = 0.8

    def __init__(self, seeds: Seeds, chance: random.Random) -> None:
        """Start from seeds."""
        self._accepted, self._given = seeds.accepted, seeds.accepted + seeds.refused
        self._seeds, self._chance = list(self._given), chance

    def keep(self, content: bytes) -> None:
        """Take a document as a seed, in the place of another where there are many."""
        if len(content) > LARGEST_SEED:
            return
        if len(self._seeds) < MOST_SEEDS:
            self._seeds.append(content)
        else:
            self._seeds[self._chance.randrange(len(self._given), MOST_SEEDS)] = content

    def next(self) -> Mutant:
        """Return a new document."""
        kind = self._chance.choices(list(self.SHARES), list(self.SHARES.values()))[0]
        if kind is Class.HARMLESS:
            return Mutant(self._harmless(), kind)
        seed, other = self._chance.choice(self._seeds), self._chance.choice(self._given)
        tree = None if kind is Class.TEXT else _tree(seed)
        if tree is None:
            return Mutant(self._with_id(text_mutations.mutate(seed, other, self._chance)), Class.TEXT)
        if kind is Class.EFFECTS:
            effect_mutations.mutate(tree, self._chance)
        if kind is Class.TREE or self._chance.random() < 0.2:
            tree_mutations.mutate(tree, _tree(other), self._chance)
        return Mutant(self._with_id(json.dumps(tree).encode()), kind)

    def _with_id(self, content: bytes) -> bytes:
        """Return the document with the id of its content, as an attacker would give it, or as it is."""
        tree = _tree(content) if self._chance.random() < self.WITH_ID else None
        if tree is None:
            return content
        old, new = str(tree.get("calibration_id")), content_id(tree)
        if content.count(old.encode(errors="replace")) == 1:
            return content.replace(old.encode(), new.encode())  # keeps duplicate names and odd literals
        return json.dumps({**tree, "calibration_id": new}).encode()

    def _harmless(self) -> bytes:
        """Return a valid document written differently, with another provenance."""
        tree = json.loads(self._chance.choice(self._accepted))
        items = list(tree.items())
        self._chance.shuffle(items)
        tree = dict(items)
        tree["training"] = {**tree["training"], "note": {"°C": [self._chance.random(), None, "µ" * 9]}}
        tree["calibration_id"] = content_id(tree)
        indent, ascii_only = self._chance.choice((None, 1, 4)), self._chance.random() < 0.5
        return json.dumps(tree, indent=indent, ensure_ascii=ascii_only).encode()


def _tree(content: bytes) -> dict[str, Any] | None:
    try:
        tree = json.loads(content)
    except (ValueError, RecursionError):
        return None
    return tree if isinstance(tree, dict) else None
