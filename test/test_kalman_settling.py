"""The closed form of the filter's variance, against the recursion in more digits than it has."""

from decimal import Decimal, localcontext
from math import log10

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.kalman.riccati import kalman_gain, riccati
from hgma_compensation.kalman.settling import AHEAD, Settling, can_tell
from hgma_compensation.kalman.stretch import DIRECT, Stretch

RATIOS = st.floats(-12.0, 6.0).map(lambda exponent: 10.0**exponent)


def exact(variance: float, added: float, white: float, steps: int) -> float:
    """Return the variance after some steps of the recursion."""
    with localcontext() as digits:
        digits.prec = 60
        moved, walk, own = Decimal(variance), Decimal(added), Decimal(white)
        for _ in range(steps):
            moved = own * (moved + walk) / (moved + walk + own)
        return float(moved)


@given(RATIOS, st.floats(-3.0, 3.0), st.floats(1e-9, 1e9), st.integers(1, 40))
def test_the_closed_form_is_the_recursion(ratio, start, white, steps):
    added = ratio * white
    limit = Settling(white, added, white).limit
    variance = 10.0**start * limit
    found = Settling(variance, added, white).between(steps, steps + 1)
    # 1e-15 of the limit are its roundings: more where the variance is far below it.
    allowed = 1e-14 * max(1.0, limit / variance)
    assert abs(float(found[0]) / exact(variance, added, white, steps) - 1.0) <= allowed


@given(RATIOS, st.integers(1, 2000))
def test_after_many_steps_too(ratio, steps):
    white = 0.3
    settling = Settling(white, ratio * white, white)
    assert abs(settling.after(steps) / exact(white, ratio * white, white, steps) - 1.0) <= 1e-14


@given(RATIOS, st.integers(1, 5 * AHEAD), st.lists(st.integers(1, 3 * AHEAD), max_size=5))
def test_it_says_the_same_one_by_one_in_parts_and_back_again(ratio, first, jumps):
    settling = Settling(1.0, ratio, 1.0)
    expected = settling.between(1, 6 * AHEAD + 1)
    for step in [first, *jumps, *range(first, first + AHEAD)]:
        assert settling.after(step) == expected[step - 1]


@given(RATIOS, st.floats(0.0, 10.0))
def test_the_variance_moves_in_one_direction_until_it_stands_at_the_limit(ratio, variance):
    steps = int(60.0 / min(ratio**0.5, 1.0)) if log10(ratio) > -6.0 else 20_000
    settling = Settling(variance, ratio, 1.0)
    moved = np.diff(np.concatenate([[variance], settling.between(1, steps)]))
    assert (moved <= 0.0).all() or (moved >= 0.0).all()
    if settling.has_settled(steps):
        assert settling.after(steps) == settling.limit
        assert abs(kalman_gain(settling.limit + ratio, 1.0) / settling.limit - 1.0) <= 1e-13 / min(ratio**0.5, 1.0)


@given(RATIOS, st.lists(st.integers(1, 3 * DIRECT), min_size=1, max_size=8))
def test_a_stretch_in_parts_is_one_step_by_step(ratio, parts):
    white, single, many = 0.7, Stretch(ratio * 0.7, 0.7), Stretch(ratio * 0.7, 0.7)
    variance = alone = white
    for count in parts:
        variances = many.variances(variance, count)
        many.take(variances)
        variance = float(variances[-1])
        for expected in variances[1:]:
            alone = single.step(kalman_gain(alone + ratio * white, white) * white)
            assert alone == expected
        assert single.has_settled == many.has_settled


def test_where_the_closed_form_cannot_tell_every_step_is_the_recursion():
    for added in (0.0, 1e-30, 1e30):
        assert not can_tell(added, 1.0)
        variances = Stretch(added, 1.0).variances(1.0, 200)
        assert variances.tolist() == riccati(1.0, [added] * 200, [1.0] * 200)
