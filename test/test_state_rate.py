"""Which samples get a state."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.pipeline.state_rate import StateRate

SAMPLES = st.lists(
    st.tuples(
        st.integers(-80_000_000, 120_000_000), st.sampled_from([0, 0, 0, 0, 1, 4]), st.sampled_from([True, True, False])
    ),
    max_size=60,
)


def columns(samples):
    stamps = 10**18 + np.cumsum(np.array([step for step, _, _ in samples], dtype=np.int64))
    return (
        stamps,
        np.array([s for _, s, _ in samples], dtype=np.uint8),
        np.array([i for _, _, i in samples], dtype=bool),
    )


@given(SAMPLES, st.sampled_from([0.0, 1.0, 20.0, 1000.0]), st.integers(0, 60))
def test_samples_in_bulk_are_chosen_as_one_after_the_other(samples, rate, cut):
    stamps, status, inside = columns(samples)
    single = StateRate(rate)
    one_by_one = [n for n in range(len(stamps)) if single.wants(int(stamps[n]), int(status[n]), bool(inside[n]))]
    bulk = StateRate(rate)
    first = bulk.choose(stamps[:cut], status[:cut], inside[:cut])
    second = bulk.choose(stamps[cut:], status[cut:], inside[cut:]) + min(cut, len(stamps))
    assert [*first.tolist(), *second.tolist()] == one_by_one


def test_an_even_stream_gets_its_rate_and_each_change():
    stamps = 10**18 + np.arange(10_000, dtype=np.int64) * 1_000_000
    status = np.zeros(10_000, dtype=np.uint8)
    status[5_003:] = 2
    chosen = StateRate(20.0).choose(stamps, status, np.ones(10_000, dtype=bool))
    assert chosen.tolist() == [*range(0, 5_001, 50), *range(5_003, 10_000, 50)]


def test_rate_0_chooses_every_sample():
    stamps = 10**18 + np.arange(7, dtype=np.int64)
    assert len(StateRate(0.0).choose(stamps, np.zeros(7, dtype=np.uint8), np.ones(7, dtype=bool))) == 7


def test_after_a_reset_the_next_sample_is_chosen():
    rate = StateRate(20.0)
    assert rate.wants(10**18, 0, True)
    assert not rate.wants(10**18 + 1, 0, True)
    rate.reset()
    assert rate.wants(10**18 + 2, 0, True)
