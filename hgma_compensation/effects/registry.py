"""The kinds of effects that there are, by name: those of this package, and those that a user adds."""

import importlib
import pkgutil
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from typing import Any, TypeVar

from hgma_compensation import effects
from hgma_compensation.effects.effect import Effect
from hgma_compensation.errors import RefusedError

_KINDS: dict[str, type[Effect]] = {}
Kind = TypeVar("Kind", bound=type[Effect])


def register(kind: Kind) -> Kind:
    """Make a kind of effect known under its name; to be used as a decorator.

    Raises ValueError where the name is taken by another kind.
    """
    known = _KINDS.setdefault(kind.name, kind)
    if known is not kind and (known.__module__, known.__qualname__) != (kind.__module__, kind.__qualname__):
        raise ValueError(f"the effect {kind.name} is there already, in {known.__module__}")
    return kind


def kinds() -> dict[str, type[Effect]]:
    """Return all kinds by name, in alphabetical order."""
    _load()
    return dict(sorted(_KINDS.items()))


@cache
def _load() -> None:
    """Import every module of this package: a new file is a new effect."""
    for module in pkgutil.iter_modules(effects.__path__):
        importlib.import_module(f"{effects.__name__}.{module.name}")


def make(name: str, parameters: Mapping[str, Any]) -> Effect:
    """Return an effect with the parameters of a calibration file.

    Raises RefusedError for an unknown name, parameters that do not fit it, and values outside their spans.
    """
    kind = kinds().get(name)
    if kind is None:
        raise RefusedError(f"effect {name[:60]!r} is unknown, must be one of {', '.join(kinds())}")
    wanted = {field.name: field.type for field in fields(kind)}  # type: ignore[arg-type]
    for parameter in wanted:
        if parameter not in parameters:
            raise RefusedError(f"parameters lacks the field {parameter!r}")
    for parameter, value in parameters.items():
        if parameter not in wanted:
            raise RefusedError(f"parameters has the unknown field {parameter[:60]!r}")
        if (parameter in kind.spans) == isinstance(value, str):
            raise RefusedError(f"parameters.{parameter} is {str(value)[:60]!r}, which has the wrong type")
    converted = {name: value if isinstance(value, str) else float(value) for name, value in parameters.items()}
    effect = kind(**converted)
    try:
        effect.check()
    except RefusedError as refusal:
        raise RefusedError(f"parameters.{refusal}") from None
    return effect
