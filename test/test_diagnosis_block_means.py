import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.diagnosis import blocks


def one_by_one(stamps, values, firsts, lasts):
    return np.array([blocks._mean(stamps[a:b], values[a:b]) for a, b in zip(firsts, lasts, strict=True)])


@given(
    seed=st.integers(0, 2**32 - 1),
    sizes=st.lists(st.sampled_from([1, 2, 3, 4, 25, 25, 25, 130]), min_size=1, max_size=30),
    resolution=st.sampled_from([0.0, 0.5, 100.0]),
    odd=st.lists(st.sampled_from([np.nan, np.inf, -np.inf, 1e3, -30.0]), max_size=8),
)
def test_blocks_formed_together_have_the_bits_of_each_alone(seed, sizes, resolution, odd):
    random = np.random.default_rng(seed)
    lasts = np.cumsum(sizes)
    firsts, count = lasts - sizes, int(lasts[-1])
    values = 9.8 + random.standard_normal(count)
    values = np.round(values / resolution) * resolution if resolution else values
    values[random.integers(0, count, len(odd))] = odd
    stamps = 10**18 + np.cumsum(random.integers(10**7, 10**9, count))
    with np.errstate(invalid="ignore"):  # a block of two infinities has no mean, one by one or not
        expected = one_by_one(stamps, values, firsts, lasts)
        means = blocks._means(stamps, values, firsts, lasts)
    assert means.tobytes() == expected.tobytes() or np.array_equal(means, expected, equal_nan=True)


def test_the_memory_that_it_takes_is_bounded_without_changing_a_bit(monkeypatch):
    random = np.random.default_rng(1)
    stamps, values = 10**18 + np.cumsum(random.integers(10**7, 10**9, 1000)), random.standard_normal(1000)
    firsts = np.arange(0, 1000, 10)
    whole = blocks._means(stamps, values, firsts, firsts + 10)
    monkeypatch.setattr(blocks, "MOST_AT_ONCE", 37)
    assert blocks._means(stamps, values, firsts, firsts + 10).tobytes() == whole.tobytes()
