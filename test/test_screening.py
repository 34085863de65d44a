import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.pipeline.reasons import Note, Skip
from hgma_compensation.pipeline.screening import out_of_step, reason_to_skip, usable_samples
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.time_jumps import TIME_JUMP

START = 1_700_000_000 * NANOSECONDS


@pytest.mark.parametrize(
    ("stamp", "value", "reason"),
    [
        (START, 9.81, None),
        (1, -1e6, None),
        (START, np.nextafter(1e6, np.inf), Skip.IMPLAUSIBLE),
        (START, -1e300, Skip.IMPLAUSIBLE),
        (START, np.nan, Skip.NOT_FINITE),
        (START, -np.inf, Skip.NOT_FINITE),
        (0, 9.81, Skip.NOT_STAMPED),
        (-1, np.nan, Skip.NOT_STAMPED),
    ],
)
def test_a_sample_has_a_stamp_and_a_value_that_a_sensor_can_send(stamp, value, reason):
    stamps, values = np.array([START, stamp]), np.array([[9.81, 0.0], [0.0, value]])
    assert reason_to_skip(stamps, values) is reason
    assert usable_samples(stamps, values).tolist() == [True, reason is None]


@given(
    steps=st.lists(st.sampled_from([0, 1, -1, TIME_JUMP, -TIME_JUMP, -TIME_JUMP - 1, 100 * NANOSECONDS]), max_size=20),
    known=st.booleans(),
)
def test_blocks_are_out_of_step_as_their_samples_are(steps, known):
    stamps = START + np.cumsum([0, *steps])
    newest = START if known else None
    whole = out_of_step(stamps, newest)
    alone = {note: 0 for note in (Note.STAMP_REPEATED, Note.OUT_OF_ORDER)}
    for stamp in stamps.tolist():
        for note, count in out_of_step(np.array([stamp]), newest).items():
            alone[note] += count
        newest = stamp if newest is None else max(newest, stamp)
    assert whole == {note: count for note, count in alone.items() if count}


def test_a_jump_back_is_not_out_of_step():
    assert out_of_step(np.array([START - TIME_JUMP - 1]), START) == {}
    assert out_of_step(np.array([START - TIME_JUMP]), START) == {Note.OUT_OF_ORDER: 1}
    assert out_of_step(np.array([START]), START) == {Note.STAMP_REPEATED: 1}
