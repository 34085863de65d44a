"""What a document from outside may hold before anything else looks at it: JSON's values, and nothing that bites later.

A number that no float64 holds overflows in the arithmetic; a lone surrogate cannot be put on a topic or a terminal, and
an escape sequence in a log is obeyed by whoever reads it; nesting is recursed into by every writer of JSON.
"""

import sys
from collections.abc import Iterable

from hgma_compensation.errors import RefusedError

DEEPEST = 32
"""Levels of nesting. Our own documents need six; a free-form part may add some."""

LONGEST_PATH = 120
"""Characters of a field's path in a message: its names may be as long as the file."""

_PLAIN = (str, int, float, bool, type(None))


def check_plain(document: object) -> None:
    """Return if the document is plain; raise RefusedError naming the first field that is not."""
    stack: list[tuple[str, int, object]] = [("", 0, document)]
    while stack:
        path, depth, value = stack.pop()
        problem = _problem(value, depth)
        if problem is not None:
            shown = path if len(path) <= LONGEST_PATH else path[: LONGEST_PATH - 3] + "..."
            raise RefusedError(f"{shown or 'the document'} {problem}")
        stack.extend(reversed([(inner, depth + 1, child) for inner, child in _children(path, value)]))


def _problem(value: object, depth: int) -> str | None:
    if isinstance(value, (dict, list)):
        if isinstance(value, dict) and not all(isinstance(name, str) and is_text(name) for name in value):
            return "has a field whose name is no printable text"
        return "is nested too deeply" if depth > DEEPEST else None
    if isinstance(value, str):
        return None if is_text(value) else "holds characters that are no printable text"
    if not isinstance(value, _PLAIN):
        return f"is a {type(value).__name__}, must be a number or a text"
    # An integer beyond the floats would overflow later; the negated comparison catches NaN too.
    if isinstance(value, (int, float)) and not abs(value) <= sys.float_info.max:
        return "is not finite"
    return None


def is_text(text: str) -> bool:
    """Return whether a text holds neither control characters nor surrogates, nor what reorders the text around it."""
    return text.isprintable()


def _children(path: str, value: object) -> Iterable[tuple[str, object]]:
    if isinstance(value, dict):
        return [(f"{path}.{name}" if path else name, child) for name, child in value.items()]
    if isinstance(value, list):
        return [(f"{path}[{index}]", child) for index, child in enumerate(value)]
    return ()
