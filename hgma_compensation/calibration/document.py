"""The calibration file: read whole or refused, written whole or not at all."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path

from hgma_compensation import schema_check
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.encoding import FORMAT, VERSION, Document, decode, encode
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically
from hgma_compensation.json_file import parse_json
from hgma_compensation.regular_file import FileKind, read_regular_file

LARGEST_FILE = 1 << 20
"""Bytes. Six channels with the largest networks, and 64 effects with all their gains, take 0.8 of it."""

MOST_COMMAS = 60_000
"""In a file; the largest calibration has half of it. Bounds what there is to make of it, and to throw away."""

LONGEST_SHOWN = 300
"""Characters of a path in a refusal."""

KIND = FileKind(
    "a calibration",
    LARGEST_FILE,
    MOST_COMMAS,
    give="give the JSON file written by hgma train",
    copy="copy it again",
    renew="take it from its source again or train again",
)


def content_id(document: Document) -> str:
    """Return the id of a document's content: everything in it but the id."""
    content = {name: value for name, value in document.items() if name != "calibration_id"}
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return "sha256-" + hashlib.sha256(text.encode()).hexdigest()[:16]


def with_id(calibration: Calibration) -> Calibration:
    """Return the calibration carrying the id of its content."""
    return replace(calibration, calibration_id=content_id(encode(calibration)))


def write_calibration(calibration: Calibration, path: Path) -> None:
    """Write a calibration that has its id; the file appears whole or not at all.

    Raises RefusedError where it cannot be written, or would be larger than what is read again.
    """
    document = encode(calibration)
    ordered = {"format": FORMAT, "version": VERSION, "calibration_id": calibration.calibration_id, **document}
    content = (json.dumps(ordered, indent=1, allow_nan=False) + "\n").encode()
    if len(content) > LARGEST_FILE:
        raise RefusedError(
            f"calibration {shown(path)} would have {len(content)} bytes, more than {LARGEST_FILE}: "
            "train on fewer recordings"
        )
    write_atomically(path, content)


def read_calibration(path: Path, *, directory: Path | None = None) -> Calibration:
    """Return the calibration in a file.

    directory: where the file must lie, after all symbolic links; None for anywhere. Raises RefusedError, naming file,
    field and remedy, for anything but a whole, valid, regular file.
    """
    try:
        return parse_calibration(read_regular_file(path, KIND, directory))
    except RefusedError as refusal:
        raise RefusedError(f"calibration {shown(path)}: {refusal}") from None


def shown(path: Path) -> str:
    """Return a path as it may stand in a line that people read: of bounded length, without control characters."""
    text = str(path) if str(path).isprintable() else ascii(str(path))
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}…"


def parse_calibration(content: bytes) -> Calibration:
    """Return the calibration in the bytes of a file; raises RefusedError."""
    document = parse_json(content, KIND)
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise RefusedError(
            f'format: this is not a calibration (no "format": "{FORMAT}"): give a file written by hgma train'
        )
    version = document.get("version")
    if version != VERSION or isinstance(version, bool):
        raise RefusedError(
            f"version is {str(version)[:20]}, this program reads version {VERSION}: "
            "train again or use the matching release"
        )
    try:
        schema_check.check(document, schema_check.load_schema(__package__, "calibration.schema.json"))
        calibration = decode(document)
    except RefusedError as refusal:
        raise RefusedError(f"{refusal}: the file was edited or damaged, take it from its source again") from None
    _check_id(document)
    return calibration


def _check_id(document: Document) -> None:
    actual = content_id(document)
    if document["calibration_id"] != actual:
        raise RefusedError(
            f"calibration_id is {document['calibration_id']}, the content has {actual}: "
            "the file was changed after it was written, take it from its source again or train again"
        )
