import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.pipeline.stretches import Cut, Stretches
from hgma_compensation.stamps import NANOSECONDS

START = 1_700_000_000


STEADY = [float(second) for second in range(4, 101, 4)]
"""A sensor that has been sending for 100 s."""


def cuts(seconds):
    """Return what Stretches says before each sample at these times after START."""
    stretches = Stretches()
    found = []
    for second in seconds:
        stamp = np.array([round((START + second) * NANOSECONDS)])
        found += [cut for _, cut in stretches.split(stamp, 10)]
    return found


def test_a_clock_that_goes_on_is_not_cut():
    assert set(cuts([0.0, 0.1, 0.1, 0.05, 3.0, -1.0, 8.0, 4.0, 13.0])) == {Cut.NONE}


def test_more_than_five_seconds_are_a_gap_and_more_than_a_minute_a_pause():
    assert cuts([0.0, 5.0, 10.1, 70.1, 130.2]) == [Cut.NONE, Cut.NONE, Cut.GAP, Cut.GAP, Cut.PAUSE]


def test_back_to_the_beginning_or_before_it_is_a_new_time_line():
    assert cuts([0.0, *STEADY, 4.9])[-1] is Cut.ANEW
    assert cuts([0.0, *STEADY, -1000.0])[-1] is Cut.ANEW


def test_back_into_the_midst_is_a_clock_that_was_set_back_unless_it_is_far():
    day = [float(second) for second in range(0, 10_000, 5)]
    assert cuts([*day, 9000.0])[-1] is Cut.SET_BACK
    assert cuts([*day, 5000.0])[-1] is Cut.ANEW


def test_a_corrected_clock_begins_earlier_too():
    seconds = [0.0, *STEADY, 20.0]
    assert cuts(seconds)[-1] is Cut.SET_BACK
    assert cuts([*seconds, 24.0, -70.0])[-1] is Cut.SET_BACK
    assert cuts([*seconds, 24.0, -76.0])[-1] is Cut.ANEW


def test_a_moment_in_the_future_is_recalled_and_a_long_stay_there_is_not():
    hours = 7200.0
    future = [hours, *(hours + second for second in range(4, 60, 4))]
    assert cuts([0.0, *STEADY, *future, 100.1])[-1] is Cut.RECALLED
    assert cuts([0.0, *STEADY, *future, hours + 60.0, hours + 61.0, 100.1])[-1] is Cut.ANEW


@pytest.mark.parametrize("ahead", [5.2, 30.0, 59.0, 1e6])
def test_one_stamp_ahead_is_recalled(ahead):
    assert cuts([0.0, *STEADY, 100.0 + ahead, 100.05])[-1] is Cut.RECALLED


@given(
    steps=st.lists(st.sampled_from([0.0, 0.1, -0.1, 4.0, -6.0, 61.0, -61.0, -4000.0, 5000.0]), max_size=40),
    longest=st.integers(1, 7),
    data=st.data(),
)
def test_any_split_into_calls_gives_the_same_cuts_and_covers_all_samples(steps, longest, data):
    stamps = (START * NANOSECONDS + np.cumsum(np.array([0.0, *steps]) * NANOSECONDS)).astype(np.int64)
    edges = sorted(data.draw(st.lists(st.integers(0, len(stamps)), max_size=4)))
    stretches, before = Stretches(), [Cut.NONE] * len(stamps)
    row = 0
    for part in np.split(stamps, edges):
        for rows, cut in stretches.split(part, longest):
            assert 0 < rows.stop - rows.start <= longest
            before[row] = cut
            row += rows.stop - rows.start
    assert row == len(stamps)
    assert before == cuts((stamps / NANOSECONDS - START).tolist())
