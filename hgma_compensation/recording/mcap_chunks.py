"""The chunks of an MCAP file that has no index of them, counted without unpacking any."""

import os
from pathlib import Path
from struct import unpack
from typing import BinaryIO

from hgma_compensation.bounded_files import open_regular

CHUNK, CHUNK_INDEX, FOOTER = 0x06, 0x08, 0x02
MAGIC, RECORD_HEAD, FOOTER_LENGTH = 8, 9, 37
DECLARED = 24
"""Bytes of a chunk up to and with the unpacked size that it declares, after its first and last time."""


def unindexed_size(file: Path) -> int:
    """Return the unpacked bytes that the chunks declare, 0 where the file has an index of them, or no chunks."""
    with open_regular(file) as content:
        end = os.fstat(content.fileno()).st_size
        if end < MAGIC + FOOTER_LENGTH:
            return 0
        content.seek(end - FOOTER_LENGTH + RECORD_HEAD)
        (summary,) = unpack("<Q", content.read(8))
        if 0 < summary < end and any(kind == CHUNK_INDEX for kind, _ in _records(content, summary, end)):
            return 0
        return sum(declared for kind, declared in _records(content, MAGIC, end) if kind == CHUNK)


def _records(content: BinaryIO, start: int, end: int) -> list[tuple[int, int]]:
    """Return the kind of each record from a place on that is a chunk or an index of one, and the size it declares."""
    found, place = [], start
    while place + RECORD_HEAD <= end:
        content.seek(place)
        kind, length = unpack("<BQ", content.read(RECORD_HEAD))
        if kind == CHUNK and place + RECORD_HEAD + DECLARED <= end:
            found.append((kind, unpack("<QQQ", content.read(DECLARED))[2]))
        elif kind == CHUNK_INDEX:
            found.append((kind, 0))
        elif kind == FOOTER:
            break
        place += RECORD_HEAD + length
    return found
