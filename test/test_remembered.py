import pickle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation.pipeline import remembered as module
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.prepared import prepare
from hgma_compensation.pipeline.remembered import THINNED, Remembered
from hgma_compensation.pipeline.sample_ring import SampleRing
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.updates import POWER_OFF

SMALL = 5
"""Samples that are kept in these tests instead of thousands."""

INTERVALS = st.sampled_from([-100.0, 0.0, 0.5, 1.0, 10.0, 29.0, 30.0, 59.0, 61.0, 500.0])


class Model:
    """What Remembered is meant to do, in lists."""

    def __init__(self):
        self.older, self.recent, self.power_on, self.came = [], [], None, []

    def add(self, stamp, value):
        self.power_on = stamp if self.power_on is None else self.power_on
        if len(self.recent) == SMALL:
            leaving, following = self.recent[0], self.recent[1][0]
            close = self.older and leaving[0] - self.older[-1][0] < THINNED
            if not close or following - leaving[0] > POWER_OFF:
                self.older.append(leaving)
        if len(self.older) > SMALL:
            if self.older[1][0] - self.older[0][0] > POWER_OFF:
                self.power_on = self.older[1][0]
            del self.older[0]
        self.recent = [*self.recent, (stamp, value)][-SMALL:]
        self.came.append((stamp, value))

    def clear(self):
        self.__init__()


def fill(both, intervals, stamp=0):
    for interval in intervals:
        stamp += round(interval * NANOSECONDS)
        for one in both:
            one.add(stamp, interval)
    return stamp


@settings(max_examples=200)
@given(st.lists(st.lists(INTERVALS, max_size=30), min_size=1, max_size=3), st.lists(INTERVALS, max_size=12))
def test_the_past_is_kept_as_in_lists_of_samples(lives, after):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "REMEMBERED", SMALL)
        kept, model = Remembered(), Model()
        for number, intervals in enumerate(lives):
            if number:
                kept.clear()
                model.clear()
            stamp = fill((kept, model), intervals)
        history, twin, before = kept.history(), kept.copy(), model.older + model.recent
        fill((kept, model), after, stamp)
    assert list(history.samples) == list(pickle.loads(pickle.dumps(history)).samples) == list(twin) == before
    assert list(kept) == model.older + model.recent
    assert kept.power_on == model.power_on
    assert kept.newest == (model.recent[-1][0] if model.recent else None)
    assert kept.follows(history) == (len(after) <= SMALL)
    if len(after) <= SMALL:
        assert list(kept.since(history)) == model.came[len(model.came) - len(after) :]


def test_samples_that_are_not_held_are_not_shown():
    ring = SampleRing(SMALL)
    ring.append(1, 2.0)
    assert (ring[0], ring[-1], len(ring), ring.full) == ((1, 2.0), (1, 2.0), 1, False)
    for index in (1, -2):
        with pytest.raises(IndexError):
            ring[index]


def test_a_state_taken_up_while_a_calibration_was_prepared_is_not_lost_to_it(calibration):
    old, live = LiveCompensation(), LiveCompensation()
    for one in (old, live):
        one.install(calibration)
    for second in range(1, 100):
        old.add_temperature(second * NANOSECONDS, 20.0 + 0.1 * second)
    live.reset()
    live.offer(old.snapshot(), 1e6)
    prepared = prepare(calibration, live.histories())
    live.add_temperature(100 * NANOSECONDS, 30.0)
    live.adopt(prepared)
    assert live.snapshot().pipeline["inputs"]["temperature"]["updates"]["first"] == NANOSECONDS
