"""One serialised sensor_msgs/Imu message at a time, where an array of one row would cost several times the numbers."""

import struct
from collections.abc import Sequence
from math import isfinite
from typing import NamedTuple

from hgma_compensation.cdr.header import Header, aligned, read_stamp
from hgma_compensation.cdr.imu import COVARIANCE_AT, DOUBLES, VALUES_AT, diagonals, read_imu_header
from hgma_compensation.channels import AXES, CHANNELS

_BODY = struct.Struct(f"<{DOUBLES}d")
_DOUBLE = struct.Struct("<d")
_UNKNOWN = bytes(len(AXES) ** 2 * _DOUBLE.size)
_VALUE_AT = dict(zip(CHANNELS, VALUES_AT.tolist(), strict=True))


class SingleImu(NamedTuple):
    """One message, with the results of ``ImuBatch`` for a single row.

    start: offset of its doubles. stamp: ns.
    """

    raw: bytes
    frame: str
    start: int
    stamp: int
    doubles: tuple[float, ...]

    @property
    def values(self) -> list[float]:
        """The six channels, in the order of CHANNELS."""
        return [self.doubles[at] for at in _VALUE_AT.values()]

    def absent(self, group: str) -> bool:
        """Return whether the message declares the field absent by -1 in its covariance (REP-145)."""
        return self.doubles[COVARIANCE_AT[group]] == -1.0

    def covariance_valid(self, group: str) -> bool:
        """Return whether the covariance of the field is finite, with no negative variance."""
        at = COVARIANCE_AT[group]
        covariance = self.doubles[at : at + len(AXES) ** 2]
        return all(map(isfinite, covariance)) and min(covariance[:: len(AXES) + 1]) >= 0.0

    def patched(self, channels: tuple[str, ...], values: Sequence[float], variances: Sequence[float] | None) -> bytes:
        """Return the message with channels (c) overwritten and variances (c) added, None for nothing."""
        patched, start = bytearray(self.raw), self.start
        for channel, value in zip(channels, values, strict=True):
            _DOUBLE.pack_into(patched, start + _DOUBLE.size * _VALUE_AT[channel], value)
        for group, diagonal in diagonals(channels):
            at, valid = COVARIANCE_AT[group], self.covariance_valid(group)
            if not valid:
                patched[start + _DOUBLE.size * at : start + _DOUBLE.size * at + len(_UNKNOWN)] = _UNKNOWN
            if variances is not None:
                for place, column in diagonal:
                    known = self.doubles[at + place] if valid else 0.0
                    _DOUBLE.pack_into(patched, start + _DOUBLE.size * (at + place), known + variances[column])
        return bytes(patched)


class SingleImuReader:
    """Reads messages that come one at a time; the layout of the one before, which is nearly always that of all."""

    def __init__(self) -> None:
        """Start without a layout."""
        self._header: Header | None = None
        self._size = self._start = 0

    def read(self, raw: bytes) -> SingleImu | None:
        """Return the message, None where its layout is not recognised."""
        header = self._header
        if header is None or len(raw) != self._size or not header.begins(raw):
            header = read_imu_header(raw)
            if header is None:
                return None
            self._header, self._size, self._start = header, len(raw), aligned(header.end)
        return SingleImu(raw, header.frame, self._start, read_stamp(raw), _BODY.unpack_from(raw, self._start))
