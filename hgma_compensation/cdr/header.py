"""The encapsulation and the std_msgs/Header that all messages here begin with.

Offsets count from the first byte of the message. CDR aligns relative to the byte after the encapsulation's four.
"""

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.cdr.rows import INT32, UINT32, fields
from hgma_compensation.stamps import NANOSECONDS, Stamps

ENCAPSULATION = b"\x00\x01\x00\x00"  # plain CDR, little-endian, no options
_STAMP = struct.Struct("<iI")
_LENGTH = struct.Struct("<I")
_SECONDS = len(ENCAPSULATION)
_NANOSECONDS = _SECONDS + 4
_FRAME = _SECONDS + _STAMP.size
STAMP = slice(_SECONDS, _FRAME)
"""Where the stamp lies."""

_TEXT = _FRAME + _LENGTH.size


class Header(NamedTuple):
    """What messages of one layout share.

    frame: frame_id. frame_bytes: its length and text as serialised. end: offset of the byte after them.
    """

    frame: str
    frame_bytes: bytes
    end: int

    def begins(self, raw: bytes) -> bool:
        """Return if a message begins with a recognised header of this frame."""
        return raw[_FRAME : self.end] == self.frame_bytes and raw.startswith(ENCAPSULATION)

    def begins_all(self, rows: NDArray[np.uint8]) -> bool:
        """Return if all the messages (n, size) begin with a recognised header of this frame."""
        plain = rows[:, :_SECONDS] == np.frombuffer(ENCAPSULATION, dtype=np.uint8)
        same = rows[:, _FRAME : self.end] == np.frombuffer(self.frame_bytes, dtype=np.uint8)
        return bool(plain.all() and same.all())


def read_header(raw: bytes | memoryview) -> Header | None:
    """Return the header of a message, None where the encapsulation or the frame is not recognised.

    The only NUL of the frame must be its last byte, and the rest UTF-8: implementations differ on anything else.
    """
    if len(raw) < _TEXT or raw[:_SECONDS] != ENCAPSULATION:
        return None
    (length,) = _LENGTH.unpack_from(raw, _FRAME)
    end = _TEXT + length
    if not 0 < length <= len(raw) - _TEXT:
        return None
    frame_bytes = bytes(raw[_FRAME:end])
    if frame_bytes.find(0, _LENGTH.size) != len(frame_bytes) - 1:
        return None
    try:
        return Header(frame_bytes[_LENGTH.size : -1].decode(), frame_bytes, end)
    except UnicodeDecodeError:
        return None


def aligned(offset: int, size: int = 8) -> int:
    """Return the next offset at which CDR places a number of that size (bytes)."""
    return offset + (len(ENCAPSULATION) - offset) % size


def read_stamp(raw: bytes | memoryview) -> int:
    """Return the stamp (ns) of a message whose header is recognised."""
    seconds, nanoseconds = _STAMP.unpack_from(raw, _SECONDS)
    return int(seconds) * NANOSECONDS + int(nanoseconds)


def read_stamps(rows: NDArray[np.uint8]) -> Stamps:
    """Return the stamps (n,) in ns of messages (n, size) whose headers are recognised."""
    seconds = fields(rows, _SECONDS, _NANOSECONDS, INT32)[:, 0].astype(np.int64)
    return np.asarray(seconds * NANOSECONDS + fields(rows, _NANOSECONDS, _FRAME, UINT32)[:, 0], dtype=np.int64)
