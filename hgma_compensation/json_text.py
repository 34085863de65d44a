"""JSON as text and back, so that other threads get their turn while a long document is read or written.

The scanner and the encoder in C hold the interpreter's lock for a document's whole length; those in Python can be
interrupted anywhere, are about eight and three times slower, and give the same.
"""

import json
import json.scanner
from collections.abc import Callable
from typing import Any

AT_ONCE = 1 << 15
"""Characters that the scanner in C may read in one go: at most 0.5 ms of nested brackets, its slowest."""

Pairs = list[tuple[str, Any]]


def parse(text: str, *, object_pairs: Callable[[Pairs], Any], constant: Callable[[str], Any]) -> Any:
    """Return the document in a text; arguments and exceptions as for the hooks of json.loads."""
    decoder = json.JSONDecoder(object_pairs_hook=object_pairs, parse_constant=constant)
    if len(text) > AT_ONCE:
        # Part of the standard library since 3.1 and used by it where C is missing, but in no stub file.
        decoder.scan_once = json.scanner.py_make_scanner(decoder)  # type: ignore[attr-defined]
    return decoder.decode(text)


def canonical(document: Any) -> str:
    """Return a document as text with sorted keys and without white space; ValueError where a number is not finite."""
    encoder = json.JSONEncoder(sort_keys=True, separators=(",", ":"), allow_nan=False)
    return "".join(encoder.iterencode(document))
