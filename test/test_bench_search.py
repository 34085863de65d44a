"""The search for the highest rate, the pace of the source, and the account of what came back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.bench.pace import send_evenly
from benchmarks.bench.search import AGAIN, FIRST, Search


class Machine:
    """Sustains every rate up to one; fails a number of trials whatever their rate."""

    def __init__(self, highest, hiccups=()):
        self.highest, self.hiccups, self.rates = highest, set(hiccups), []

    def trial(self, rate):
        self.rates.append(rate)
        return rate <= self.highest and len(self.rates) not in self.hiccups


@given(highest=st.floats(30.0, 150_000.0), first=st.floats(25.0, 150_000.0), search=st.sampled_from([FIRST, Search()]))
def test_the_highest_rate_is_found_from_wherever_it_begins(highest, first, search):
    machine = Machine(highest)
    found = search.highest_rate(machine.trial, first)
    assert found <= highest
    assert found * search.finest * (1.0 + 1e-6) >= highest
    assert len(machine.rates) < 60


@given(highest=st.floats(1000.0, 2000.0), hiccups=st.sets(st.integers(1, 20)).map(lambda n: {2 * k for k in n}))
def test_a_trial_that_fails_once_is_tried_again(highest, hiccups):
    # No two in a row, and each rate has two attempts.
    machine = Machine(highest, hiccups)
    assert FIRST.highest_rate(machine.trial, 1000.0) * FIRST.finest * (1.0 + 1e-6) >= highest


def test_going_on_from_the_rate_before_takes_few_trials():
    machine = Machine(1000.0)
    assert AGAIN.highest_rate(machine.trial, 1000.0) == 1000.0
    assert machine.rates == pytest.approx([1000.0, 1050.0, 1050.0])


def test_where_nothing_succeeds_the_search_says_so():
    with pytest.raises(RuntimeError, match="no trial succeeded"):
        FIRST.highest_rate(lambda rate: False, 1000.0)


def test_the_search_ends_at_the_highest_rate_there_is():
    machine = Machine(np.inf)
    found = Search(highest=5000.0).highest_rate(machine.trial, 1000.0)
    assert 5000.0 / 1.5 < found <= 5000.0


@pytest.mark.parametrize(("rate", "seconds", "count"), [(100.0, 0.05, 5), (1500.0, 0.04, 60), (20_000.0, 0.02, 400)])
def test_the_source_sends_each_sample_once_and_in_order(rate, seconds, count):
    sent, served = [], []
    pace = send_evenly(rate, seconds, sent.append, lambda: served.append(len(sent)))
    assert sent == list(range(count))
    assert pace.sent == count
    # Never more than a millisecond's samples between two looks at what has come back.
    assert np.diff(served).max() <= max(1.0, np.ceil(rate * 1e-3))
    assert served[-1] == count


def test_the_source_gives_up_when_it_is_told_to():
    sent = []
    pace = send_evenly(1000.0, 10.0, sent.append, lambda: None, give_up=lambda count: count >= 7)
    assert pace.sent == len(sent) == 7
