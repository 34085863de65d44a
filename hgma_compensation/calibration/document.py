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
from hgma_compensation.json_file import FileKind, parse_json, read_bytes

LARGEST_FILE = 4 << 20
"""Bytes. The largest network that the schema allows is a tenth of it."""

KIND = FileKind(
    "a calibration",
    LARGEST_FILE,
    give="give the JSON file written by hgma train",
    copy="copy it again",
    renew="take it from its source again",
)


def content_id(document: Document) -> str:
    """Return the id of a document's content: everything in it but the id."""
    content = {name: value for name, value in document.items() if name != "calibration_id"}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return "sha256-" + hashlib.sha256(canonical.encode()).hexdigest()[:16]


def with_id(calibration: Calibration) -> Calibration:
    """Return the calibration carrying the id of its content."""
    return replace(calibration, calibration_id=content_id(encode(calibration)))


def write_calibration(calibration: Calibration, path: Path) -> None:
    """Write a calibration that has its id; the file appears whole or not at all."""
    document = encode(calibration)
    ordered = {"format": FORMAT, "version": VERSION, "calibration_id": calibration.calibration_id, **document}
    write_atomically(path, (json.dumps(ordered, indent=1, allow_nan=False) + "\n").encode())


def read_calibration(path: Path) -> Calibration:
    """Return the calibration in a file.

    Raises RefusedError, naming file, field and remedy, for anything but a whole, valid file.
    """
    try:
        return parse_calibration(read_bytes(path, KIND))
    except RefusedError as refusal:
        raise RefusedError(f"calibration {path}: {refusal}") from None


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
    try:
        actual = content_id(document)
    except RecursionError:
        raise RefusedError("training is nested too deeply: the file is damaged") from None
    if document["calibration_id"] != actual:
        raise RefusedError(
            f"calibration_id is {document['calibration_id']}, the content has {actual}: "
            "the file was changed after it was written, take it from its source again or train again"
        )
