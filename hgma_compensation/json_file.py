"""JSON files from anywhere: read with a bound, parsed whole or refused; nothing that they hold hangs or crashes."""

import json
import os
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hgma_compensation import schema_check
from hgma_compensation.errors import RefusedError

Document = dict[str, Any]


@dataclass(frozen=True)
class FileKind:
    """What a refusal says of a kind of file.

    name: with its article. largest: bytes. Then what to do: give, where it is another thing; copy, where it was cut
    short; renew, where its content is damaged.
    """

    name: str
    largest: int
    give: str
    copy: str
    renew: str


def read_bytes(path: Path, kind: FileKind) -> bytes:
    """Return the content of a regular file of bounded size; raises RefusedError for anything else."""
    try:
        # Not blocking: opening a named pipe would otherwise wait for a writer that never comes.
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    except OSError as error:
        raise RefusedError(f"cannot be opened ({error.strerror}): check the path and its permissions") from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise RefusedError(f"is not a regular file: {kind.give}")
        if status.st_size > kind.largest:
            raise RefusedError(f"has {status.st_size} bytes, more than {kind.largest}: this is not {kind.name}")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            return file.read(kind.largest)
    except OSError as error:
        raise RefusedError(f"cannot be read ({error.strerror}): {kind.copy}") from None
    finally:
        os.close(descriptor)


def parse_json(content: bytes, kind: FileKind) -> Any:
    """Return the document in the bytes of a file: finite numbers only, no name given twice; raises RefusedError."""

    def refuse_constant(name: str) -> Any:
        raise RefusedError(f"holds {name}, which is no number: the file is damaged, {kind.renew}")

    def unique(pairs: list[tuple[str, Any]]) -> Document:
        document = dict(pairs)
        if len(document) < len(pairs):
            names = [name for name, _ in pairs]
            twice = next(name for name in names if names.count(name) > 1)
            raise RefusedError(f"{twice} is given twice: the file was edited, {kind.renew}")
        return document

    try:
        document = json.loads(content.decode("utf-8"), parse_constant=refuse_constant, object_pairs_hook=unique)
    except RefusedError:
        raise
    except UnicodeDecodeError:
        raise RefusedError(f"is not UTF-8 text: {kind.give}") from None
    except json.JSONDecodeError as error:
        raise RefusedError(
            f"is not complete JSON (line {error.lineno}: {error.msg}): it is truncated or damaged, {kind.copy}"
        ) from None
    except (RecursionError, ValueError):
        raise RefusedError(f"is not {kind.name}: it is nested too deeply or holds an absurd number") from None
    path = schema_check.find_non_finite(document)
    if path is not None:
        raise RefusedError(f"{path} is not finite: the file is damaged, {kind.renew}")
    return document
