"""What is looked at before a bag is opened, and before its messages are read: files, database, sizes of chunks."""

import re
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path, PurePath
from typing import Any
from urllib.parse import quote

from rosbags.rosbag2.storage_mcap import zstd

from hgma_compensation.bounded_files import open_regular, read_text
from hgma_compensation.errors import RefusedError
from hgma_compensation.plain_yaml import load_plain
from hgma_compensation.recording.mcap_chunks import unindexed_size

LARGEST_METADATA = 4 << 20
EXPANSION = 200
"""Unpacked bytes for one in the file. Messages of a sensor without any noise reach 34."""

ALWAYS_ALLOWED = 256 << 20
"""Unpacked bytes that a file of any size may have."""

MOST_AT_ONCE = 256 << 20
"""Unpacked bytes of chunks that overlap in time, all of which are held to bring their messages into order."""

SMALLEST_ROW = 8
"""Bytes that a row of a database needs at the least."""

_PLAIN_SQL = re.compile(r"\s*CREATE\s+(TABLE|(UNIQUE\s+)?INDEX)\b", re.IGNORECASE)
_COMPUTED = re.compile(r"\b(AS|GENERATED)\b", re.IGNORECASE)
_STEPS = 10_000


def storage_files(path: Path) -> list[Path]:
    """Return the files that hold the messages of a bag, all of them regular; raises RefusedError.

    A name in metadata.yaml stands for a file of the bag's folder, wherever it points.
    """
    if not path.is_dir():
        open_regular(path).close()
        return [path]
    metadata = load_plain(read_text(path / "metadata.yaml", LARGEST_METADATA))
    try:
        names = metadata["rosbag2_bagfile_information"]["relative_file_paths"]  # type: ignore[index]
        files = [path / PurePath(name).name for name in names]
    except (KeyError, TypeError):
        raise RefusedError("metadata.yaml is not that of a bag: run ros2 bag reindex") from None
    for file in files:
        open_regular(file).close()
    return files


def check_file(file: Path) -> None:
    """Raise RefusedError for a storage file that could make the one who reads it run out of memory or time."""
    if file.suffix == ".zstd":
        _check_compressed(file)
    elif file.suffix == ".db3":
        _check_database(file)
    elif unindexed_size(file) > allowed(file):
        raise _too_large(file)


def allowed(file: Path) -> int:
    """Return the unpacked bytes that a file of its size may hold."""
    return max(EXPANSION * file.stat().st_size, ALWAYS_ALLOWED)


def _too_large(file: Path) -> RefusedError:
    return RefusedError(f"{file.name} unpacks to more than {allowed(file)} bytes: it is no recording")


def _check_compressed(file: Path) -> None:
    """Unpack a file without keeping it: the library unpacks it to the disk, whatever becomes of it."""
    left = allowed(file)
    with open_regular(file) as packed, zstd.open(packed, "rb") as unpacked:
        while block := unpacked.read(1 << 20):
            left -= len(block)
            if left < 0:
                raise _too_large(file)


def _check_database(file: Path) -> None:
    """Refuse tables that are computed rather than stored, and trees of pages that do not end."""
    with closing(sqlite3.connect(f"file:{quote(str(file))}?mode=ro&immutable=1", uri=True)) as database:
        steps_left = 1_000 + file.stat().st_size * 8 // (SMALLEST_ROW * _STEPS)

        def ends() -> bool:
            nonlocal steps_left
            steps_left -= 1
            return steps_left < 0

        database.set_progress_handler(ends, _STEPS)
        for (sql,) in database.execute("SELECT sql FROM sqlite_master WHERE sql IS NOT NULL"):
            if not _PLAIN_SQL.match(sql) or _COMPUTED.search(sql):
                raise RefusedError(f"{file.name} computes its tables ({sql[:60]!r}): it is no recording")
        # Rows are visited one by one, first in the order of the table, then in that of an index.
        for query in ("SELECT sum(1) FROM messages NOT INDEXED", "SELECT sum(1), max(timestamp) FROM messages"):
            database.execute(query).fetchone()


def check_chunks(chunks: Iterable[Any], file: Path) -> None:
    """Raise RefusedError where chunks of an MCAP file unpack to more than may be, in all or at once."""
    ends = []
    for chunk in chunks:
        ends.append((chunk.message_start_time, 1, chunk.uncompressed_size))
        ends.append((max(chunk.message_start_time, chunk.message_end_time), 2, -chunk.uncompressed_size))
    if sum(size for _, order, size in ends if order == 1) > allowed(file):
        raise _too_large(file)
    held = 0
    for _, _, size in sorted(ends):
        held += size
        if held > MOST_AT_ONCE:
            raise RefusedError(f"{file.name} has chunks of more than {MOST_AT_ONCE} bytes at one time: record it again")
