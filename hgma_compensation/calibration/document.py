"""The calibration file: read whole or refused, written whole or not at all."""

import hashlib
import json
import os
import stat
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

from hgma_compensation import schema_check
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.encoding import FORMAT, VERSION, Document, decode, encode
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically
from hgma_compensation.plain_values import check_plain

LARGEST_FILE = 4 << 20
"""Bytes. The largest network that the schema allows is a tenth of it."""


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
        return parse_calibration(_read_bytes(path))
    except RefusedError as refusal:
        raise RefusedError(f"calibration {path}: {refusal}") from None


def parse_calibration(content: bytes) -> Calibration:
    """Return the calibration in the bytes of a file; raises RefusedError."""
    document = _parse_json(content)
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


def _read_bytes(path: Path) -> bytes:
    try:
        # Not blocking: opening a named pipe would otherwise wait for a writer that never comes.
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    except OSError as error:
        raise RefusedError(f"cannot be opened ({error.strerror}): check the path and its permissions") from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise RefusedError("is not a regular file: give the JSON file written by hgma train")
        if status.st_size > LARGEST_FILE:
            raise RefusedError(f"has {status.st_size} bytes, more than {LARGEST_FILE}: this is not a calibration")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            return file.read(LARGEST_FILE)
    except OSError as error:
        raise RefusedError(f"cannot be read ({error.strerror}): copy it again") from None
    finally:
        os.close(descriptor)


def _parse_json(content: bytes) -> Any:
    try:
        document = json.loads(content.decode("utf-8"), parse_constant=_refuse_constant, object_pairs_hook=_unique)
    except RefusedError:
        raise
    except UnicodeDecodeError:
        raise RefusedError("is not UTF-8 text: give the JSON file written by hgma train") from None
    except json.JSONDecodeError as error:
        raise RefusedError(
            f"is not complete JSON (line {error.lineno}: {error.msg}): it is truncated or damaged, copy it again"
        ) from None
    except (RecursionError, ValueError):
        raise RefusedError("is not a calibration: it is nested too deeply or holds an absurd number") from None
    try:
        check_plain(document)
    except RefusedError as refusal:
        raise RefusedError(f"{refusal}: the file is damaged, take it from its source again or train again") from None
    return document


def _refuse_constant(name: str) -> Any:
    raise RefusedError(
        f"holds {name}, which is no number: the file is damaged, take it from its source again or train again"
    )


def _unique(pairs: list[tuple[str, Any]]) -> Document:
    document = dict(pairs)
    if len(document) < len(pairs):
        ((twice, _),) = Counter(name for name, _ in pairs).most_common(1)
        raise RefusedError(f"{twice[:60]} is given twice: the file was edited, take it from its source again")
    return document
