"""A serialised hgma_msgs/AccelBlock, read and patched without a copy for each axis."""

import struct
from collections.abc import Mapping
from operator import eq

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.cdr.header import STAMP, Header, aligned, read_header, read_stamp
from hgma_compensation.channels import AXES

_INTERVAL = struct.Struct("<d")
_LENGTH = struct.Struct("<I")
_FLOAT32 = np.dtype("<f4")


class BlockLayout:
    """Where the parts of blocks of one frame, interval and length lie, all axes being equally long.

    count: samples of each axis. frame: frame_id. sample_interval: s, unchecked.
    """

    def __init__(self, view: "BlockView") -> None:
        """Take the layout of a block; raises ValueError where its axes differ in length."""
        spans = view.spans
        self.count = len(view.x)
        if any(len(getattr(view, axis)) != self.count for axis in AXES):
            raise ValueError("axes of different lengths")
        self.frame, self.sample_interval = view.frame, view.sample_interval
        raw = bytes(view.raw)
        self._size, self._start = len(raw), spans[AXES[0]].start
        # All but the stamp, the samples and the gap before the interval, in which anything may stand.
        interval = self._start - _LENGTH.size - _INTERVAL.size
        self._fixed = [slice(0, STAMP.start), slice(STAMP.stop, view.header_end), slice(interval, self._start)]
        self._fixed += [slice(spans[axis].start - _LENGTH.size, spans[axis].start) for axis in AXES[1:]]
        self._bytes = [raw[part] for part in self._fixed]
        self._strides = (self.count * _FLOAT32.itemsize + _LENGTH.size, _FLOAT32.itemsize)

    def holds(self, raw: bytes | memoryview) -> bool:
        """Return whether a message is laid out like this."""
        return len(raw) == self._size and all(map(eq, map(raw.__getitem__, self._fixed), self._bytes))

    def axes(self, raw: bytes | bytearray) -> NDArray[np.float32]:
        """Return the axes (3, n) of a message on its memory, m/s²."""
        return np.ndarray((len(AXES), self.count), _FLOAT32, raw, self._start, self._strides)


class BlockView:
    """One AccelBlock on the memory of the message.

    raw: the message. header_end: where its header ends. spans: of the axes in it. stamp: of the first sample, ns.
    frame: frame_id. sample_interval: s, unchecked. x, y, z: m/s², read-only where the message is; their lengths may
    differ.
    """

    def __init__(self, raw: bytes | memoryview, header: Header, interval: float, spans: Mapping[str, slice]) -> None:
        """Take a message whose axes lie at these offsets."""
        self.raw = raw
        self.header_end = header.end
        self.spans = spans
        self.stamp = read_stamp(raw)
        self.frame = header.frame
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
        return cls(raw, header, _INTERVAL.unpack_from(raw, start)[0], spans)

    def patched(self, axes: Mapping[str, NDArray[np.float32]]) -> bytes:
        """Return the message with axes overwritten by arrays of their length; every other byte stays as it is.

        Raises ValueError where a length differs.
        """
        message = memoryview(self.raw)
        parts: list[memoryview] = []
        done = 0
        for axis, span in self.spans.items():
            if axis in axes:
                samples = np.ascontiguousarray(axes[axis], dtype=_FLOAT32)
                if samples.shape != getattr(self, axis).shape:
                    raise ValueError(f"axis {axis} has {getattr(self, axis).size} samples, not {samples.shape}")
                parts += [message[done : span.start], samples.data]
                done = span.stop
        # One allocation and one copy: join reads the arrays' own memory.
        return b"".join([*parts, message[done:]])
