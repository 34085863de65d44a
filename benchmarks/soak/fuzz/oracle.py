"""Whether a document that was accepted ought to have been: judged without the parser's own code.

jsonschema reads the published schema; the id, the plainness and the rules that no schema expresses are computed again.
"""

import hashlib
import json
import sys
import unicodedata
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema

SCHEMA = Path(__file__).parents[3] / "hgma_compensation" / "calibration" / "calibration.schema.json"
UNITS = {"linear_acceleration": "m/s^2", "angular_velocity": "rad/s"}
DEEPEST = 32
UNPRINTABLE = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}


def problem_of(content: bytes) -> str | None:
    """Return why a document must not be accepted, None where it may."""
    try:
        document = json.loads(content.decode("utf-8"), parse_constant=_no_constant, object_pairs_hook=_no_duplicates)
    except ValueError as error:
        return f"no JSON: {error}"
    broken = next(_validator().iter_errors(document), None)
    if broken is not None:
        return f"against the schema: {broken.message[:200]}"
    if document["calibration_id"] != content_id(document):
        return "its id is not that of its content"
    return next(_unfit(document, 0), None) or next(_broken_rules(document), None)


def content_id(document: dict[str, Any]) -> str:
    """Return the id of a document as the schema describes it."""
    content = {name: value for name, value in document.items() if name != "calibration_id"}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return "sha256-" + hashlib.sha256(canonical.encode()).hexdigest()[:16]


@cache
def _validator() -> Any:
    return jsonschema.Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8")))


def _no_constant(name: str) -> None:
    raise ValueError(f"{name} is no JSON")


def _no_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len({name for name, _ in pairs}) < len(pairs):
        raise ValueError("a name is given twice")
    return dict(pairs)


def _unfit(value: Any, depth: int) -> Iterator[str]:
    if isinstance(value, (dict, list)):
        if depth > DEEPEST:
            yield f"nested deeper than {DEEPEST}"
        for child in value.values() if isinstance(value, dict) else value:
            yield from _unfit(child, depth + 1)
        for name in value if isinstance(value, dict) else ():
            yield from _unfit(name, depth)
    elif isinstance(value, str):
        if any(unicodedata.category(c) in UNPRINTABLE or (c != " " and c.isspace()) for c in value):
            yield f"{value[:40]!r} is no printable text"
    elif isinstance(value, (int, float)) and not abs(value) <= sys.float_info.max:
        yield f"{str(value)[:20]} is not finite"


def _broken_rules(document: dict[str, Any]) -> Iterator[str]:
    for name, (low, high) in document["calibrated_range"].items():
        if not low < high:
            yield f"the range of {name} is empty"
    names = [channel["name"] for channel in document["channels"]]
    if len(set(names)) < len(names):
        yield "a channel is given twice"
    for channel in document["channels"]:
        if channel["unit"] != UNITS[channel["name"].split(".")[0]]:
            yield f"{channel['name']} has the unit of another"
        drift = channel["drift"]
        rows = ("centres", "widths", "weights") if drift["method"] == "rbf" else ("exponents", "coefficients")
        if len({len(drift[name]) for name in rows}) > 1:
            yield f"{channel['name']} has a drift of ragged shape"
    for effect in document["effects"]:
        if effect["channel"] not in names:
            yield f"an effect is on {effect['channel']}, which is not calibrated"
