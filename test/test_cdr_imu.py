from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_cdr_header import ANY_DOUBLE, FRAMES, NANOSECONDS, ORACLES, SECONDS, Rclpy, Rosbags, bits, corrupted

from hgma_compensation.cdr.imu import ImuBatch, batches
from hgma_compensation.cdr.rows import stacked, unstacked
from hgma_compensation.channels import CHANNELS, GROUPS, group_of
from hgma_compensation.messages import absent_groups, imu_values, patch_covariances, patch_imu, stamp_of
from hgma_compensation.recording.typestore import IMU, typestore

NINE = st.lists(ANY_DOUBLE, min_size=9, max_size=9)
VALID = st.lists(st.floats(0.0, 1e300), min_size=9, max_size=9)
ABSENT = VALID.map(lambda covariance: [-1.0, *covariance[1:]])
COVARIANCES = st.one_of(VALID, ABSENT, NINE, st.just([0.0] * 9)).map(np.array)
VECTORS = st.tuples(ANY_DOUBLE, ANY_DOUBLE, ANY_DOUBLE)
BODIES = st.tuples(SECONDS, NANOSECONDS, NINE, COVARIANCES, VECTORS, COVARIANCES, VECTORS, COVARIANCES)
ZEROS = (1, 2, *[np.zeros(n) for n in (4, 9, 3, 9, 3, 9)])
SOME_CHANNELS = st.lists(st.sampled_from(CHANNELS), min_size=1, unique=True)


def serialised(oracle, frame, body):
    seconds, nanoseconds, quaternion, orientation, rate, rate_covariance, acceleration, acceleration_covariance = body
    message = oracle.new(
        IMU,
        oracle.header(seconds, nanoseconds, frame),
        oracle.new("geometry_msgs/msg/Quaternion", *quaternion[:4]),
        orientation,
        oracle.new("geometry_msgs/msg/Vector3", *rate),
        rate_covariance,
        oracle.new("geometry_msgs/msg/Vector3", *acceleration),
        acceleration_covariance,
    )
    return oracle.serialised(message, IMU)


def fields_of(message):
    """Return all that the message holds, floats as bits."""
    q = message.orientation
    covariances = [getattr(message, f"{group}_covariance") for group in ("orientation", *GROUPS)]
    doubles = [[q.x, q.y, q.z, q.w], imu_values(message), *covariances]
    return stamp_of(message), message.header.frame_id, [bits(part) for part in doubles]


def check_read(batch, messages):
    """Hold what the batch says of its messages against what the ordinary path reads in them."""
    assert {message.header.frame_id for message in messages} == {batch.frame}
    assert batch.stamps.tolist() == [stamp_of(message) for message in messages]
    assert bits(batch.values) == bits([imu_values(message) for message in messages])
    for group in GROUPS:
        assert batch.absent(group).tolist() == [group in absent_groups(message) for message in messages]


def only_batch(raws):
    ((place, batch),) = batches(raws)
    assert (place.start, place.stop) == (0, len(raws))
    assert batch is not None
    return batch


@pytest.mark.parametrize("oracle", ORACLES)
@given(frame=FRAMES, bodies=st.lists(BODIES, min_size=1, max_size=4), channels=SOME_CHANNELS, data=st.data())
def test_messages_are_read_and_patched_as_the_ordinary_path_does(oracle, frame, bodies, channels, data):
    raws = [serialised(oracle, frame, body) for body in bodies]
    batch = only_batch(raws)
    check_read(batch, [oracle.deserialised(raw, IMU) for raw in raws])

    places = st.integers(0, len(raws) - 1)
    rows = data.draw(st.one_of(st.lists(places, min_size=1, max_size=5), st.builds(slice, places, st.none())))
    chosen = raws[rows] if isinstance(rows, slice) else [raws[row] for row in rows]
    numbers = st.lists(ANY_DOUBLE, min_size=len(channels), max_size=len(channels))
    values = np.array([data.draw(numbers) for _ in chosen])
    # A row of NaN says what None says to the ordinary path.
    added = st.one_of(st.none(), numbers.filter(lambda row: not np.isnan(row).all()))
    variances = [data.draw(added) for _ in chosen]
    unknown = [np.nan] * len(channels)
    array = np.array([unknown if row is None else row for row in variances])
    if all(row is None for row in variances) and data.draw(st.booleans()):
        array = None
    patched = unstacked(batch.patched(rows if isinstance(rows, slice) else np.array(rows), channels, values, array))

    valid = []
    for raw, output, new, variance in zip(chosen, patched, values, variances, strict=True):
        expected = oracle.deserialised(raw, IMU)
        patch_imu(expected, channels, new.tolist())
        valid.append(patch_covariances(expected, channels, None if variance is None else np.array(variance)))
        assert fields_of(oracle.deserialised(output, IMU)) == fields_of(expected)
        assert output[:-296] == raw[:-296]
    groups = {group_of(channel) for channel in channels}
    assert batch.covariances_valid(groups)[rows].tolist() == valid


@given(frame=FRAMES, body=BODIES)
def test_patching_by_what_is_there_changes_no_byte(frame, body):
    raw = serialised(Rosbags(), frame, (*body[:5], np.zeros(9), body[6], np.full(9, -0.0)))
    batch = only_batch([raw, raw])
    for variances in (None, np.full((2, 6), np.nan)):
        assert unstacked(batch.patched(slice(None), CHANNELS, batch.values, variances)) == [raw, raw]


@given(frame=FRAMES, body=BODIES)
def test_a_batch_leaves_its_messages_alone_and_its_values_are_its_own(frame, body):
    raw = serialised(Rosbags(), frame, body)
    rows = stacked([raw, raw]).copy()
    batch = ImuBatch.of_rows(rows)
    assert batch is not None
    batch.patched(slice(None), CHANNELS, batch.values + 1.0, np.ones((2, 6)))
    batch.values[:] = 7.0
    assert unstacked(rows) == [raw, raw]


@given(st.lists(st.tuples(st.sampled_from(["", "imu", "imv", "imu_link", None]), BODIES), max_size=8))
def test_runs_of_one_layout_are_found_in_order(kinds):
    raws = [b"\0" * 324 if frame is None else serialised(Rosbags(), frame, body) for frame, body in kinds]
    runs = list(batches(raws))
    assert [n for place, _ in runs for n in range(place.start, place.stop)] == list(range(len(raws)))
    frames = [None if batch is None else batch.frame for _, batch in runs]
    for place, batch in runs:
        if batch is None:
            assert place.stop == place.start + 1
            assert kinds[place.start][0] is None
        else:
            check_read(batch, [Rosbags().deserialised(raw, IMU) for raw in raws[place]])
    assert all(a is None or a != b for a, b in pairwise(frames))


@given(frames=st.lists(st.sampled_from(["imu", "imv"]), min_size=1, max_size=4), body=BODIES)
def test_rows_are_a_batch_where_all_have_one_frame(frames, body):
    raws = [serialised(Rosbags(), frame, body) for frame in frames]
    batch = ImuBatch.of_rows(stacked(raws))
    assert (batch is not None) == (len(set(frames)) == 1)
    if batch is not None:
        check_read(batch, [Rosbags().deserialised(raw, IMU) for raw in raws])


@pytest.mark.ros
@given(frame=FRAMES, body=BODIES, data=st.data())
def test_a_corrupted_message_is_read_as_rclpy_reads_it_or_not_at_all(frame, body, data):
    raw = data.draw(corrupted(serialised(Rosbags(), frame, body)))
    ((_, batch),) = batches([raw])
    rows = ImuBatch.of_rows(np.frombuffer(raw, dtype=np.uint8).reshape(1, -1))
    assert (rows is None) == (batch is None)
    if batch is not None:
        check_read(batch, [Rclpy().deserialised(raw, IMU)])


@pytest.mark.parametrize("change", [lambda raw: raw[:-1], lambda raw: raw + b"\0", lambda raw: raw + b"\0" * 8])
def test_a_message_of_another_size_is_not_recognised(change):
    raw = serialised(Rosbags(), "imu", ZEROS)
    assert [batch is None for _, batch in batches([raw, change(raw), raw])] == [False, True, False]


class BigEndian(Rosbags):
    def serialised(self, message, name):
        return bytes(typestore().serialize_cdr(message, name, little_endian=False))


def test_big_endian_is_not_recognised_nor_is_nothing():
    assert [batch for _, batch in batches([serialised(BigEndian(), "imu", ZEROS)])] == [None]
    assert ImuBatch.of_rows(np.empty((0, 320), dtype=np.uint8)) is None
    assert not list(batches([]))
