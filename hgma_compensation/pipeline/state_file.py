"""The file that keeps a node's memory over a restart: read whole or refused, replaced whole or left as it was."""

import hashlib
import json
import re
import stat
from collections.abc import Callable
from itertools import islice
from pathlib import Path

from hgma_compensation import schema_check
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically
from hgma_compensation.json_file import parse_json
from hgma_compensation.pipeline.live_state import LiveState, decode_state, encode_state
from hgma_compensation.regular_file import FileKind, read_regular_file

VERSION = 1
LARGEST_FILE = 4 << 20
"""Bytes; a thermistor at 1 Hz makes about 20 kB and 4 kB for each hour, at most 100 kB."""

MOST_COMMAS = 400_000
"""In a file: no number of it takes fewer than ten characters."""

BATCH = 64
"""Pieces of JSON that are made between two rests."""

_REMEDY = "the node starts without it and replaces it"
KIND = FileKind("a state", LARGEST_FILE, MOST_COMMAS, give="name another state_file", copy=_REMEDY, renew=_REMEDY)
_BEGINNING = b'{"format":"hgma_state",'
_HEADER = re.compile(
    rb'\{"format":"hgma_state","version":(?P<version>\d{1,9}),"checksum":"sha256-(?P<checksum>[0-9a-f]{64})","content":'
)
_END = b"}\n"


def write_state(state: LiveState, path: Path, rest: Callable[[], object]) -> int:
    """Write a state and return its size in bytes; the file is the old one or the new one at any moment.

    rest: called again and again in between, to let other threads run. Raises RefusedError where it cannot be written,
    and where the path holds something else, which is left alone.
    """
    check_replaceable(path)
    content = encode_bytes(state, rest)
    if len(content) > LARGEST_FILE:
        raise RefusedError(
            f"{path} would need {len(content)} bytes, more than {LARGEST_FILE}: slow the thermistor down"
        )
    write_atomically(path, content)
    return len(content)


def encode_bytes(state: LiveState, rest: Callable[[], object]) -> bytes:
    """Return the bytes of a state's file; raises RefusedError for a state with a number that is not finite."""
    encoder = json.JSONEncoder(sort_keys=True, separators=(",", ":"), allow_nan=False)
    # Piece by piece: json.dumps would hold all other threads up until it is done.
    pieces, parts = encoder.iterencode(encode_state(state)), []
    try:
        while batch := "".join(islice(pieces, BATCH)):
            parts.append(batch)
            rest()
    except ValueError:
        raise RefusedError("the memory holds a number that is not finite: call ~/reset") from None
    content = "".join(parts).encode()
    checksum = hashlib.sha256(content).hexdigest()
    return _BEGINNING + f'"version":{VERSION},"checksum":"sha256-{checksum}","content":'.encode() + content + _END


def read_state(path: Path) -> LiveState | None:
    """Return the state in a file, None where there is no file yet; raises RefusedError for anything else."""
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise RefusedError(f"state_file {path} cannot be read ({error.strerror}): {_REMEDY}") from None
    try:
        return parse_state(read_regular_file(path, KIND))
    except RefusedError as refusal:
        raise RefusedError(f"state_file {path}: {refusal}") from None


def parse_state(content: bytes) -> LiveState:
    """Return the state in the bytes of a file; raises RefusedError."""
    header = _HEADER.match(content)
    if header is None:
        remedy = _REMEDY if content.startswith(_BEGINNING) or not content else KIND.give
        raise RefusedError(f"format: this is not a state written by compensation_node: {remedy}")
    if int(header["version"]) != VERSION:
        raise RefusedError(f"version is {int(header['version'])}, this program reads version {VERSION}: {_REMEDY}")
    body = content[header.end() : -len(_END)]
    if not content.endswith(_END) or hashlib.sha256(body).hexdigest().encode() != header["checksum"]:
        raise RefusedError(f"checksum does not fit the content: the file is damaged, {_REMEDY}")
    document = parse_json(body, KIND)
    try:
        schema_check.check(document, schema_check.load_schema(__package__, "state.schema.json"))
        return decode_state(document)
    except (RefusedError, ValueError) as error:
        raise RefusedError(f"{error}: the file was edited, {_REMEDY}") from None


def check_replaceable(path: Path) -> None:
    """Raise RefusedError where the path holds anything but nothing, an empty file or a state."""
    try:
        status = path.lstat()
    except OSError:
        return
    if not stat.S_ISREG(status.st_mode) or (status.st_size and not _begins_like_a_state(path)):
        raise RefusedError(f"{path} holds something else, which is left alone: name another state_file")


def _begins_like_a_state(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return file.read(len(_BEGINNING)) == _BEGINNING
    except OSError:
        return False


def remove_litter(path: Path) -> int:
    """Remove what interrupted writes of this file left beside it, and return how many files that were."""
    # The names that write_atomically gives: the file's own, hidden, with eight random characters.
    litter = re.compile(rf"\.{re.escape(path.name)}\.[a-z0-9_]{{8}}")
    removed = 0
    try:
        for entry in path.parent.iterdir():
            if litter.fullmatch(entry.name) and stat.S_ISREG(entry.lstat().st_mode):
                entry.unlink()
                removed += 1
    except OSError:
        # Nothing depends on it; a folder that cannot be read or written is said at the first save.
        return removed
    return removed
