"""A serialised hgma_msgs/AccelBlock, read and patched without a copy for each axis."""

import struct
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.cdr.header import aligned, read_header, read_stamp
from hgma_compensation.channels import AXES

_INTERVAL = struct.Struct("<d")
_LENGTH = struct.Struct("<I")
_FLOAT32 = np.dtype("<f4")


class BlockView:
    """One AccelBlock on the memory of the message.

    stamp: of the first sample, ns. frame: frame_id. sample_interval: s, unchecked. x, y, z: m/s², read-only where the
    message is; their lengths may differ.
    """

    def __init__(self, raw: bytes | memoryview, frame: str, interval: float, spans: Mapping[str, slice]) -> None:
        """Take a message whose axes lie at these offsets."""
        self._raw = raw
        self._spans = spans
        self.stamp = read_stamp(raw)
        self.frame = frame
        self.sample_interval = interval
        self.x, self.y, self.z = (
            np.frombuffer(raw, _FLOAT32, (span.stop - span.start) // _FLOAT32.itemsize, span.start)
            for span in (spans[axis] for axis in AXES)
        )

    @classmethod
    def of(cls, raw: bytes | memoryview) -> "BlockView | None":
        """Return the block that a message is, None where its layout is not recognised."""
        header = read_header(raw)
        start = aligned(header.end) if header is not None else len(raw)
        end = start + _INTERVAL.size
        if header is None or end > len(raw):
            return None
        spans = {}
        for axis in AXES:
            if end + _LENGTH.size > len(raw):
                return None
            (count,) = _LENGTH.unpack_from(raw, end)
            first = end + _LENGTH.size
            end = first + count * _FLOAT32.itemsize
            spans[axis] = slice(first, end)
        if end != len(raw):
            return None
        return cls(raw, header.frame, _INTERVAL.unpack_from(raw, start)[0], spans)

    def patched(self, axes: Mapping[str, NDArray[np.float32]]) -> bytes:
        """Return the message with axes overwritten by arrays of their length; every other byte stays as it is.

        Raises ValueError where a length differs.
        """
        message = memoryview(self._raw)
        parts: list[memoryview] = []
        done = 0
        for axis, span in self._spans.items():
            if axis in axes:
                samples = np.ascontiguousarray(axes[axis], dtype=_FLOAT32)
                if samples.shape != getattr(self, axis).shape:
                    raise ValueError(f"axis {axis} has {getattr(self, axis).size} samples, not {samples.shape}")
                parts += [message[done : span.start], samples.data]
                done = span.stop
        # One allocation and one copy: join reads the arrays' own memory.
        return b"".join([*parts, message[done:]])
