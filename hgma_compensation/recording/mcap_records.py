"""The messages in one unpacked chunk of an MCAP file (https://mcap.dev/spec), found without walking over them."""

from struct import Struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag2.errors import ReaderError

from hgma_compensation.recording.batch import Indices, windows

MESSAGE, MESSAGE_INDEX = 0x05, 0x07
MESSAGE_HEAD = np.dtype(
    [("kind", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("logged", "<u8"), ("sent", "<u8")]
)
"""What stands before the data of a message. length: of all that follows it, in bytes. logged, sent: ns."""

RECORD_HEAD = 9
"""Bytes of the kind and the length that every record begins with."""

INDEX_ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
_RECORD = Struct("<BQ")
_INDEX = Struct("<BQHI")
_OWN = MESSAGE_HEAD.itemsize - RECORD_HEAD


class Messages(NamedTuple):
    """The n messages of a chunk in the order in which they lie there.

    channels: (n,). times: (n,) uint64, ns. starts, sizes: (n,) of their data in the chunk.
    """

    channels: NDArray[np.uint16]
    times: NDArray[np.uint64]
    starts: Indices
    sizes: Indices


def find_messages(chunk: bytes, index: bytes) -> Messages:
    """Return the messages of a chunk, by its message indexes as far as these are right.

    chunk: unpacked. index: the bytes of the MessageIndex records after the chunk. Raises ReaderError where a record
    does not end.
    """
    offsets = _offsets(index)
    found = None if offsets is None else _at(chunk, offsets)
    return _walked(chunk) if found is None else found


def _offsets(index: bytes) -> Indices | None:
    """Return the offsets (n,) that the indexes give, sorted; None where they are damaged."""
    parts, place = [np.empty(0, dtype=np.uint64)], 0
    while place < len(index):
        if place + _INDEX.size > len(index):
            return None
        kind, length, _, size = _INDEX.unpack_from(index, place)
        start, place = place + _INDEX.size, place + RECORD_HEAD + length
        if kind != MESSAGE_INDEX or start + size > min(place, len(index)) or size % INDEX_ENTRY.itemsize:
            return None
        parts.append(np.frombuffer(index, INDEX_ENTRY, size // INDEX_ENTRY.itemsize, start)["offset"])
    offsets = np.sort(np.concatenate(parts))
    return offsets.astype(np.int64) if not len(offsets) or offsets[-1] < 2**62 else None


def _at(chunk: bytes, offsets: Indices) -> Messages | None:
    """Return the messages at offsets; None where these are not all that a walk over the chunk would find."""
    memory, size = np.frombuffer(chunk, dtype=np.uint8), len(chunk)
    if len(offsets) and offsets[-1] + MESSAGE_HEAD.itemsize > size:
        return None
    if not len(offsets):
        return _nothing() if _without_messages(chunk, 0, size) else None
    heads = windows(memory, MESSAGE_HEAD.itemsize)[offsets].view(MESSAGE_HEAD)[:, 0]
    lengths = heads["length"]
    if (heads["kind"] != MESSAGE).any() or (lengths < _OWN).any() or (lengths > size).any():
        return None
    ends = offsets + RECORD_HEAD + lengths.astype(np.int64)
    follow = np.append(offsets[1:], size)
    # Whatever the indexes say: records that lie end to end are those that a walk finds.
    if not _without_messages(chunk, 0, int(offsets[0])):
        return None
    for row in np.flatnonzero(ends != follow).tolist():
        if not _without_messages(chunk, int(ends[row]), int(follow[row])):
            return None
    sizes = lengths.astype(np.int64) - _OWN
    return Messages(heads["channel"], heads["logged"], offsets + MESSAGE_HEAD.itemsize, sizes)


def _without_messages(chunk: bytes, place: int, end: int) -> bool:
    """Return whether from a place on there are records up to an end, and no message among them."""
    while place < end:
        if place + RECORD_HEAD > end:
            return False
        kind, length = _RECORD.unpack_from(chunk, place)
        if kind == MESSAGE:
            return False
        place += RECORD_HEAD + length
    return place == end


def _walked(chunk: bytes) -> Messages:
    """Return the messages, record by record."""
    starts, place = [], 0
    while place < len(chunk):
        if place + RECORD_HEAD > len(chunk):
            raise ReaderError(f"a record at {place} of a chunk does not end")
        kind, length = _RECORD.unpack_from(chunk, place)
        if kind == MESSAGE:
            if length < _OWN or place + RECORD_HEAD + length > len(chunk):
                raise ReaderError(f"a message at {place} of a chunk has {length} bytes")
            starts.append(place)
        place += RECORD_HEAD + length
    if not starts:
        return _nothing()
    offsets = np.array(starts, dtype=np.int64)
    heads = windows(np.frombuffer(chunk, dtype=np.uint8), MESSAGE_HEAD.itemsize)[offsets].view(MESSAGE_HEAD)[:, 0]
    sizes = heads["length"].astype(np.int64) - _OWN
    return Messages(heads["channel"], heads["logged"], offsets + MESSAGE_HEAD.itemsize, sizes)


def _nothing() -> Messages:
    empty = np.empty(0, dtype=np.int64)
    return Messages(empty.astype(np.uint16), empty.astype(np.uint64), empty, empty)
