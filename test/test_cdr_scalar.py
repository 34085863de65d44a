import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_cdr_header import ANY_DOUBLE, FRAMES, NANOSECONDS, ORACLES, SECONDS, Rclpy, Rosbags, bits, corrupted

from hgma_compensation.cdr.rows import stacked
from hgma_compensation.cdr.scalar import SUPPLY_VOLTAGE_DOUBLES, TEMPERATURE_DOUBLES, scalar_columns
from hgma_compensation.messages import stamp_of
from hgma_compensation.recording.typestore import SUPPLY_VOLTAGE, TEMPERATURE

KINDS = [(TEMPERATURE, TEMPERATURE_DOUBLES, "temperature"), (SUPPLY_VOLTAGE, SUPPLY_VOLTAGE_DOUBLES, "voltage")]
ROWS = st.tuples(SECONDS, NANOSECONDS, ANY_DOUBLE, ANY_DOUBLE)


def serialised(oracle, kind, frame, row):
    name, doubles, _ = kind
    message = oracle.new(name, oracle.header(*row[:2], frame), *row[2 : 2 + doubles])
    return oracle.serialised(message, name)


def check_read(columns, messages, field):
    stamps, values = columns
    assert stamps.tolist() == [stamp_of(message) for message in messages]
    assert bits(values) == bits([getattr(message, field) for message in messages])


@pytest.mark.parametrize("kind", KINDS, ids=["temperature", "supply voltage"])
@pytest.mark.parametrize("oracle", ORACLES)
@given(frame=FRAMES, rows=st.lists(ROWS, min_size=1, max_size=4))
def test_columns_are_what_the_ordinary_path_reads(oracle, kind, frame, rows):
    raws = [serialised(oracle, kind, frame, row) for row in rows]
    columns = scalar_columns(stacked(raws), kind[1])
    assert columns is not None
    check_read(columns, [oracle.deserialised(raw, kind[0]) for raw in raws], kind[2])
    assert scalar_columns(stacked(raws), 3 - kind[1]) is None  # the other kind


@pytest.mark.ros
@pytest.mark.parametrize("kind", KINDS, ids=["temperature", "supply voltage"])
@given(frame=FRAMES, row=ROWS, data=st.data())
def test_a_corrupted_message_is_read_as_rclpy_reads_it_or_not_at_all(kind, frame, row, data):
    raw = data.draw(corrupted(serialised(Rosbags(), kind, frame, row)))
    columns = scalar_columns(np.frombuffer(raw, dtype=np.uint8).reshape(1, -1), kind[1])
    if columns is not None:
        check_read(columns, [Rclpy().deserialised(raw, kind[0])], kind[2])


@given(frames=st.lists(st.sampled_from(["a", "b"]), max_size=4))
def test_one_frame_is_in_all_rows_or_none_is_recognised(frames):
    raws = [serialised(Rosbags(), KINDS[0], frame, (1, 2, 3.0, 4.0)) for frame in frames]
    rows = stacked(raws) if raws else np.empty((0, 40), dtype=np.uint8)
    assert (scalar_columns(rows, TEMPERATURE_DOUBLES) is not None) == (len(set(frames)) == 1)
