import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.pipeline.stretches import Cut, Stretches
from hgma_compensation.stamps import NANOSECONDS

START = 1_700_000_000


def cuts(seconds):
    """Return what Stretches says before each sample at these times after START."""
    stretches = Stretches()
    found = []
    for second in seconds:
        stamp = np.array([round((START + second) * NANOSECONDS)])
        found += [cut for _, cut in stretches.split(stamp, 10)]
    return found


def test_a_clock_that_goes_on_is_not_cut():
    assert set(cuts([0.0, 0.1, 0.1, 0.05, 3.0, -1.0, 60.0, 56.0, 120.0])) == {Cut.NONE}


def test_more_than_a_minute_is_a_pause():
    assert cuts([0.0, 60.0, 120.1]) == [Cut.NONE, Cut.NONE, Cut.PAUSE]


def test_back_to_the_beginning_or_before_it_is_a_new_time_line():
    assert cuts([0.0, 50.0, 4.9])[-1] is Cut.ANEW
    assert cuts([0.0, 50.0, -1000.0])[-1] is Cut.ANEW


def test_back_into_the_midst_is_a_clock_that_was_set_back_unless_it_is_far():
    day = [float(second) for second in range(0, 10_000, 50)]
    assert cuts([*day, 9000.0])[-1] is Cut.SET_BACK
    assert cuts([*day, 5000.0])[-1] is Cut.ANEW


def test_a_corrected_clock_begins_earlier_too():
    seconds = [0.0, 50.0, 100.0, 20.0]
    assert cuts(seconds)[-1] is Cut.SET_BACK
    assert cuts([*seconds, 60.0, -50.0])[-1] is Cut.SET_BACK
    assert cuts([*seconds, 60.0, -76.0])[-1] is Cut.ANEW


def test_a_moment_in_the_future_is_recalled_and_a_long_stay_there_is_not():
    hours = 7200.0
    assert cuts([0.0, 50.0, hours, hours + 59.0, 50.1])[2:] == [Cut.PAUSE, Cut.NONE, Cut.RECALLED]
    assert cuts([0.0, 50.0, hours, hours + 50.0, hours + 61.0, 50.1])[-1] is Cut.ANEW


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
