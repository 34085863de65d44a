from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation.pipeline.condensed import NEWEST, OLDER, condensed
from hgma_compensation.pipeline.remembered import Remembered
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.updates import POWER_OFF


def remembered(seconds):
    return Remembered.of(None, [(round(second * NANOSECONDS), 20.0) for second in seconds])


def test_the_newest_stay_as_they_came_and_the_older_are_thinned():
    kept = [stamp // NANOSECONDS for stamp, _ in condensed(remembered(range(4000)))]
    assert kept[-NEWEST:] == list(range(4000 - NEWEST, 4000))
    assert kept[:3] == [0, 30, 60]
    assert len(kept) < NEWEST + 4000 // 30 + 2


def test_it_is_bounded_and_knows_the_power_on_before_it():
    seconds = [*range(0, 3000, 20), *range(10_000, 10_000 + 3 * 30 * OLDER, 30)]
    kept = condensed(remembered(seconds))
    assert len(list(kept)) == OLDER + NEWEST
    assert kept.power_on == 10_000 * NANOSECONDS
    assert next(iter(kept))[0] > kept.power_on


def test_nothing_is_condensed_to_nothing():
    assert (list(condensed(Remembered())), condensed(Remembered()).power_on) == ([], None)


STEPS = (0.5, 1.0, 10.0, 25.0, 29.0, 31.0, 40.0, 59.0, 61.0, 500.0)


@settings(max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 3 * NEWEST))
def test_thinning_neither_makes_nor_hides_a_pause_without_power(seed, count):
    whole = remembered(np.cumsum(np.random.default_rng(seed).choice(STEPS, count)))
    kept = condensed(whole)
    samples = [stamp for stamp, _ in kept]
    assert set(samples) <= {stamp for stamp, _ in whole}
    assert samples[-NEWEST:] == [stamp for stamp, _ in whole][-NEWEST:]
    assert samples[0] == next(iter(whole))[0]

    def pauses(stamps):
        return [(a, b) for a, b in pairwise(stamps) if b - a > POWER_OFF]

    assert pauses(samples) == pauses([stamp for stamp, _ in whole])
