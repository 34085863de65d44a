import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_cdr_header import ANY_DOUBLE, FRAMES, NANOSECONDS, ORACLES, SECONDS, Rclpy, Rosbags, bits, corrupted

from hgma_compensation.cdr.block import BlockView
from hgma_compensation.channels import AXES, CHANNELS
from hgma_compensation.messages import patch_block, stamp_of
from hgma_compensation.recording.typestore import ACCEL_BLOCK

# Every pattern of bits but signalling NaN, which the conversion to float64 and back makes quiet.
QUIET = st.integers(0, 2**32 - 1).map(lambda n: n | 0x0040_0000 if n & 0x7FFF_FFFF > 0x7F80_0000 else n)
SAMPLES = st.lists(QUIET, max_size=5)
EQUAL = st.integers(0, 5).flatmap(lambda n: st.tuples(*[st.lists(QUIET, min_size=n, max_size=n)] * 3))
UNEQUAL = st.tuples(SAMPLES, SAMPLES, SAMPLES)
HEADERS = st.tuples(SECONDS, NANOSECONDS, FRAMES)


def floats(patterns):
    return np.array(patterns, dtype=np.uint32).view(np.float32)


def patterns(samples):
    return np.asarray(samples, dtype=np.float32).view(np.uint32).tolist()


def serialised(oracle, header, interval, axes):
    message = oracle.new(ACCEL_BLOCK, oracle.header(*header), interval, *map(floats, axes))
    return oracle.serialised(message, ACCEL_BLOCK)


def check_read(view, message):
    assert (view.stamp, view.frame) == (stamp_of(message), message.header.frame_id)
    assert bits(view.sample_interval) == bits(message.sample_interval)
    assert [patterns(getattr(view, axis)) for axis in AXES] == [patterns(getattr(message, axis)) for axis in AXES]


@pytest.mark.parametrize("oracle", ORACLES)
@given(header=HEADERS, interval=ANY_DOUBLE, axes=st.one_of(EQUAL, UNEQUAL), odd=st.booleans())
def test_a_block_is_read_as_the_ordinary_path_does(oracle, header, interval, axes, odd):
    raw = serialised(oracle, header, interval, axes)
    view = BlockView.of(memoryview(b"-" + raw)[1:] if odd else raw)
    assert view is not None
    check_read(view, oracle.deserialised(raw, ACCEL_BLOCK))


@pytest.mark.parametrize("oracle", ORACLES)
@given(header=HEADERS, axes=EQUAL, channels=st.sets(st.sampled_from(CHANNELS)).map(sorted), data=st.data())
def test_a_block_is_patched_as_the_ordinary_path_does(oracle, header, axes, channels, data):
    raw = serialised(oracle, header, 1e-4, axes)
    values = np.array([data.draw(st.tuples(*[ANY_DOUBLE] * len(channels))) for _ in axes[0]])
    values = values.reshape(len(axes[0]), len(channels))
    view = BlockView.of(raw)
    assert view is not None
    with np.errstate(over="ignore", invalid="ignore"):
        columns = {c[-1]: values[:, n].astype(np.float32) for n, c in enumerate(channels) if c in CHANNELS[:3]}
        expected = oracle.deserialised(raw, ACCEL_BLOCK)
        patch_block(expected, channels, values)
    patched = view.patched(columns)
    assert type(patched) is bytes
    output = BlockView.of(patched)
    assert output is not None
    check_read(output, expected)
    # The padding too stays as it is.
    assert view.patched({}) == raw
    assert output.patched({axis: getattr(view, axis) for axis in AXES}) == raw


@given(header=HEADERS, axes=UNEQUAL, axis=st.sampled_from(AXES))
def test_an_axis_is_overwritten_by_strided_samples_of_its_length_only(header, axes, axis):
    view = BlockView.of(serialised(Rosbags(), header, 1e-4, axes))
    assert view is not None
    size = len(getattr(view, axis))
    samples = np.arange(2 * size, dtype=np.float32)[::2]
    output = BlockView.of(view.patched({axis: samples}))
    assert output is not None
    for other in AXES:
        wanted = samples if other == axis else getattr(view, other)
        assert patterns(getattr(output, other)) == patterns(wanted)
    with pytest.raises(ValueError, match=f"axis {axis}"):
        view.patched({axis: np.zeros(size + 1, dtype=np.float32)})


def test_the_axes_lie_in_the_message():
    raw = serialised(Rosbags(), (1, 2, "imu"), 1e-4, [[1, 2]] * 3)
    view = BlockView.of(raw)
    assert view is not None
    assert all(np.shares_memory(getattr(view, axis), np.frombuffer(raw, np.uint8)) for axis in AXES)


@pytest.mark.ros
@given(header=HEADERS, axes=st.one_of(EQUAL, UNEQUAL), data=st.data())
def test_a_corrupted_block_is_read_as_rclpy_reads_it_or_not_at_all(header, axes, data):
    raw = data.draw(corrupted(serialised(Rosbags(), header, 1e-4, axes)))
    view = BlockView.of(raw)
    if view is not None:
        check_read(view, Rclpy().deserialised(raw, ACCEL_BLOCK))


@given(header=HEADERS, axes=UNEQUAL)
def test_every_truncated_or_longer_block_is_not_recognised(header, axes):
    raw = serialised(Rosbags(), header, 1e-4, axes)
    assert [size for size in range(len(raw) + 1) if BlockView.of(raw[:size]) is not None] == [len(raw)]
    assert BlockView.of(raw + b"\0") is None


@pytest.mark.parametrize("count", [3, 2**30, 2**32 - 1])
def test_a_length_beyond_the_message_is_not_recognised(count):
    raw = serialised(Rosbags(), (1, 2, "imu"), 1e-4, [[1, 2]] * 3)
    assert BlockView.of(raw[:-12] + struct.pack("<I", count) + raw[-8:]) is None
