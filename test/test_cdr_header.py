"""The header of serialised messages, and what the tests of all serialised messages share."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.cdr.header import ENCAPSULATION, aligned, read_header, read_stamp, read_stamps
from hgma_compensation.cdr.rows import stacked, unstacked
from hgma_compensation.recording.typestore import typestore

FRAMES = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=40)
SECONDS = st.one_of(st.sampled_from([-(2**31), -1, 0, 2**31 - 1]), st.integers(-(2**31), 2**31 - 1))
NANOSECONDS = st.one_of(st.sampled_from([0, 999_999_999, 2**32 - 1]), st.integers(0, 2**32 - 1))


def double(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


# Every pattern of bits: NaN of any payload, -0.0 and subnormal numbers among them.
ANY_DOUBLE = st.one_of(
    st.sampled_from([0.0, -0.0, -1.0, np.inf, -np.inf, np.nan, 5e-324, double(0x7FF8_0000_0000_BEEF)]),
    st.floats(),
    st.integers(0, 2**64 - 1).map(double),
)


def bits(values):
    return np.asarray(values, dtype=np.float64).view(np.uint64).tolist()


class Rosbags:
    """Messages as rosbags has them."""

    def header(self, seconds, nanoseconds, frame):
        return self.new("std_msgs/msg/Header", self.new("builtin_interfaces/msg/Time", seconds, nanoseconds), frame)

    def new(self, name, *fields):
        return typestore().types[name](*fields)

    def serialised(self, message, name):
        return bytes(typestore().serialize_cdr(message, name, little_endian=True))

    def deserialised(self, raw, name):
        return typestore().deserialize_cdr(raw, name)


class Rclpy(Rosbags):
    """Messages as rclpy has them; their serialised padding is not always zero."""

    def new(self, name, *fields):
        message = self.type_of(name)()
        for field, value in zip(message.get_fields_and_field_types(), fields, strict=True):
            setattr(message, field, value)
        return message

    def type_of(self, name):
        package, _, message = name.split("/")
        return getattr(__import__(f"{package}.msg").msg, message)

    def serialised(self, message, name):
        from rclpy.serialization import serialize_message

        return serialize_message(message)

    def deserialised(self, raw, name):
        from rclpy.serialization import deserialize_message

        return deserialize_message(raw, self.type_of(name))


ORACLES = [pytest.param(Rosbags(), id="rosbags"), pytest.param(Rclpy(), id="rclpy", marks=pytest.mark.ros)]


@st.composite
def corrupted(draw, raw):
    """Return the message after some changes, more of them in its header, where the layout is decided."""
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.one_of(st.integers(0, min(24, len(raw))), st.integers(0, len(raw))))
        added = draw(st.one_of(st.sampled_from([b"", b"\0", b"\xff", b"\0" * 4]), st.binary(max_size=8)))
        removed = draw(st.one_of(st.just(len(added)), st.sampled_from([0, 1, 4, 8, len(raw)])))
        raw = raw[:at] + added + raw[at + removed :]
    return raw


def with_header(text, length=None, encapsulation=ENCAPSULATION, stamp=(1, 2)):
    length = len(text) if length is None else length
    return encapsulation + struct.pack("<iII", *stamp, length) + text


@given(frame=FRAMES, seconds=SECONDS, nanoseconds=NANOSECONDS)
def test_a_header_is_read(frame, seconds, nanoseconds):
    raw = with_header(frame.encode() + b"\0", stamp=(seconds, nanoseconds))
    header = read_header(raw)
    assert header is not None
    assert (header.frame, header.end) == (frame, len(raw))
    assert read_header(memoryview(raw + b"body")) == header
    assert header.begins(raw)
    assert read_stamp(raw) == seconds * 10**9 + nanoseconds
    assert read_stamps(stacked([raw, raw])).tolist() == [read_stamp(raw)] * 2


@pytest.mark.parametrize(
    "raw",
    [
        b"",
        with_header(b"imu\0")[:15],
        with_header(b"imu\0", encapsulation=b"\0\0\0\0"),  # big-endian
        with_header(b"imu\0", encapsulation=b"\0\7\0\0"),  # XCDR2
        with_header(b"imu\0", encapsulation=b"\0\3\0\0"),  # parameter list
        with_header(b"imu\0", encapsulation=b"\0\1\0\3"),  # padded
        with_header(b"", length=0),
        with_header(b"imu", length=3),  # no NUL
        with_header(b"i\0u\0"),
        with_header(b"imu\0\0"),
        with_header(b"\xff\xfe\0"),
        with_header(b"\xed\xa0\x80\0"),  # a surrogate
        with_header(b"imu\0", length=5),
        with_header(b"imu\0", length=2**32 - 1),
    ],
)
def test_what_implementations_read_differently_is_not_recognised(raw):
    assert read_header(raw) is None


@pytest.mark.parametrize("place", [0, 1, 2, 3, 12, 15, 16, 18])
def test_another_header_is_told_apart(place):
    raw = with_header(b"imu\0")
    other = bytearray(raw)
    other[place] ^= 1
    header = read_header(raw)
    assert header is not None
    assert not header.begins(bytes(other))
    assert not header.begins_all(stacked([raw, bytes(other), raw]))
    assert header.begins_all(stacked([raw, raw]))


def test_numbers_are_aligned_relative_to_the_encapsulation():
    assert [aligned(offset) for offset in (4, 5, 11, 12, 13)] == [4, 12, 12, 12, 20]


@given(st.lists(st.binary(min_size=5, max_size=5), min_size=1, max_size=4))
def test_messages_become_rows_and_messages_again(raws):
    rows = stacked(raws)
    assert rows.shape == (len(raws), 5)
    assert unstacked(rows) == raws
    assert unstacked(rows[::2]) == raws[::2]


@pytest.mark.parametrize("raws", [[], [b"abc", b"ab"]])
def test_messages_of_different_lengths_are_no_rows(raws):
    with pytest.raises(ValueError, match="equal length"):
        stacked(raws)
