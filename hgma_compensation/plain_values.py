"""What a document from outside may hold before anything else looks at it: JSON's values, and nothing that bites later.

A number that no float64 holds overflows in the arithmetic; a lone surrogate cannot be put on a topic or a terminal, and
an escape sequence in a log is obeyed by whoever reads it; nesting is recursed into by every writer of JSON.
"""

import sys
from collections.abc import Iterator

from hgma_compensation.errors import RefusedError

DEEPEST = 32
"""Levels of nesting. Our own documents need six; a free-form part may add some."""

MOST_VALUES = 200_000
"""Ten times what the largest calibration has. A file of a few megabytes holds millions."""

LONGEST_PATH = 120
"""Characters of a field's path in a message: its names may be as long as the file."""

_PLAIN = (str, int, float, bool, type(None))


def check_plain(document: object) -> None:
    """Return if the document is plain; raise RefusedError naming the first field that is not."""
    for seen, (path, depth, value) in enumerate(_fields(document)):
        if seen == MOST_VALUES:
            raise RefusedError(f"the document has more than {MOST_VALUES} values")
        problem = _problem(value, depth)
        if problem is not None:
            shown = path if len(path) <= LONGEST_PATH else path[: LONGEST_PATH - 3] + "..."
            raise RefusedError(f"{shown or 'the document'} {problem}")


def _fields(document: object) -> Iterator[tuple[str, int, object]]:
    """Yield path, depth and value of every field, what contains others before them.

    One by one: the paths of all of them together would take more memory than the document.
    """
    branches: list[Iterator[tuple[str, object]]] = [iter([("", document)])]
    while branches:
        for path, value in branches[-1]:
            yield path, len(branches) - 1, value
            branches.append(_children(path, value))
            break
        else:
            branches.pop()


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


def _children(path: str, value: object) -> Iterator[tuple[str, object]]:
    if isinstance(value, dict):
        yield from ((f"{path}.{name}" if path else name, child) for name, child in value.items())
    elif isinstance(value, list):
        yield from ((f"{path}[{index}]", child) for index, child in enumerate(value))
