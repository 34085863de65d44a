from math import exp

import numpy as np
import pytest
from builders import SCALING
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.drift.inputs import InputScaling, weighted_sum
from hgma_compensation.drift.polynomial import CUBIC, CUBIC_WITH_RATE, PolynomialDrift, monomials
from hgma_compensation.drift.radial_basis import RadialBasisDrift, basis, hidden_layer

SEED = 20190725
SIZES = {"seed": st.integers(0, 2**32 - 1), "n": st.integers(1, 200), "m": st.integers(1, 40)}


def network(random, m):
    return RadialBasisDrift(
        SCALING,
        centres=random.uniform(-1.0, 1.0, (m, 3)),
        widths=random.uniform(0.3, 3.0, (m, 3)),
        weights=random.normal(0.0, 10.0, m),
        bias=float(random.normal()),
        linear=random.normal(0.0, 5.0, 3),
    )


def polynomial(random, m):
    exponents = random.integers(0, 4, (m, 3))
    return PolynomialDrift(SCALING, exponents, random.normal(0.0, 5.0, m))


def layouts(features):
    """The same numbers, laid out in memory in the ways that slices, stacks and transposes leave them."""
    wide = np.zeros((2 * len(features), 7))
    wide[::2, 1:6:2] = features
    backward = np.ascontiguousarray(features[::-1])
    return [np.asfortranarray(features), wide[::2, 1:6:2], backward[::-1]]


@pytest.mark.parametrize("make", [network, polynomial])
@given(cuts=st.lists(st.integers(0, 200), max_size=6), **SIZES)
def test_evaluation_is_the_same_bits_for_any_chunks_and_layout(make, seed, n, m, cuts):
    random = np.random.default_rng(seed)
    drift = make(random, m)
    features = SCALING.offset + SCALING.scale * random.uniform(-1.5, 1.5, (n, 3))
    batch = drift.evaluate(features).tobytes()
    assert np.concatenate([drift.evaluate(features[k : k + 1]) for k in range(n)]).tobytes() == batch
    chunks = np.split(features, sorted(min(cut, n) for cut in cuts))
    assert np.concatenate([drift.evaluate(chunk) for chunk in chunks]).tobytes() == batch
    for other in layouts(features):
        assert drift.evaluate(other).tobytes() == batch
        assert drift.evaluate(other[n // 2 : n // 2 + 1]).tobytes() == batch[8 * (n // 2) : 8 * (n // 2) + 8]


def test_hidden_layer_is_equation_3():
    random = np.random.default_rng(SEED)
    inputs, centres = random.uniform(-1.0, 1.0, (20, 3)), random.uniform(-1.0, 1.0, (6, 3))
    widths = random.uniform(1.0, 3.0, (6, 3))
    expected = np.empty((20, 6))
    for i, x in enumerate(inputs.tolist()):
        for j, (c, w) in enumerate(zip(centres.tolist(), widths.tolist(), strict=True)):
            expected[i, j] = exp(-sum((x[k] - c[k]) ** 2 / (2.0 * w[k] ** 2) for k in range(3)))
    # Exponents are at most 6: ten roundings of them make 6 * 10 * 2^-53 < 1e-14.
    np.testing.assert_allclose(hidden_layer(inputs, centres, widths), expected, rtol=1e-14)


def test_population_axis_holds_one_network_after_the_other():
    random = np.random.default_rng(SEED)
    inputs, centres = random.uniform(-1.0, 1.0, (20, 3)), random.uniform(-1.0, 1.0, (5, 6, 3))
    widths = random.uniform(0.3, 3.0, (5, 6, 3))
    together = basis(inputs, centres, widths)
    assert together.shape == (5, 20, 10)
    for one, c, w in zip(together, centres, widths, strict=True):
        np.testing.assert_array_equal(one, basis(inputs, c, w))


def test_basis_is_hidden_layer_then_one_then_inputs():
    random = np.random.default_rng(SEED)
    inputs, drift = random.uniform(-1.0, 1.0, (20, 3)), network(random, 6)
    columns = basis(inputs, drift.centres, drift.widths)
    np.testing.assert_array_equal(columns[:, :6], hidden_layer(inputs, drift.centres, drift.widths))
    np.testing.assert_array_equal(columns[:, 6], np.ones(20))
    np.testing.assert_array_equal(columns[:, 7:], inputs)


def test_evaluation_is_weights_times_layer_plus_bias_plus_linear_term():
    random = np.random.default_rng(SEED)
    drift, features = network(random, 6), SCALING.offset + SCALING.scale * random.uniform(-1.0, 1.0, (20, 3))
    x = (features - SCALING.offset) / SCALING.scale
    terms = np.column_stack([hidden_layer(x, drift.centres, drift.widths) * drift.weights, x * drift.linear])
    rounding = 12 * np.finfo(float).eps * (np.abs(terms).sum(axis=1) + abs(drift.bias))
    assert (np.abs(drift.evaluate(features) - (terms.sum(axis=1) + drift.bias)) <= rounding).all()


@given(**SIZES)
def test_weighted_sum_of_a_row_hears_no_other_row(seed, n, m):
    random = np.random.default_rng(seed)
    columns, weights = random.standard_normal((n, m)), random.standard_normal(m)
    row = int(random.integers(n))
    before = weighted_sum(columns, weights)
    exact = [sum(abs(c * w) for c, w in zip(r, weights, strict=True)) for r in columns]
    np.testing.assert_array_less(np.abs(before - columns @ weights), 2 * (m + 1) * 2.0**-53 * np.array(exact) + 1e-300)
    columns[np.arange(n) != row] = np.nan
    assert weighted_sum(columns, weights)[row] == before[row]


@pytest.mark.parametrize("exponents", [CUBIC, CUBIC_WITH_RATE, np.array([[2, 1, 3], [0, 0, 1], [4, 0, 0]])])
def test_polynomial_equals_numpys(exponents):
    random = np.random.default_rng(SEED)
    drift = PolynomialDrift(SCALING, exponents, random.normal(0.0, 5.0, len(exponents)))
    features = SCALING.offset + SCALING.scale * random.uniform(-1.0, 1.0, (50, 3))
    table = np.zeros(exponents.max(axis=0) + 1)
    table[tuple(exponents.T)] = drift.coefficients
    x = (features - SCALING.offset) / SCALING.scale
    expected = np.polynomial.polynomial.polyval3d(*x.T, table)
    # |x| <= 1, at most 8 roundings in each term and in their sum, on both sides.
    rounding = 16 * np.finfo(float).eps * np.abs(drift.coefficients).sum()
    np.testing.assert_allclose(drift.evaluate(features), expected, rtol=0.0, atol=rounding)


def test_monomials_are_products_of_powers():
    np.testing.assert_array_equal(
        monomials(np.array([[2.0, 3.0, 5.0], [0.0, 0.0, 0.0]]), np.array([[0, 0, 0], [1, 0, 0], [3, 1, 2]])),
        [[1.0, 2.0, 8.0 * 3.0 * 25.0], [1.0, 0.0, 0.0]],
    )


def test_scaling_standardises_and_leaves_a_constant_feature_its_unit():
    features = np.column_stack([[1.0, 2.0, 3.0, 6.0], [7.0, 7.0, 7.0, 7.0]])
    scaled = InputScaling.of(features).apply(features)
    np.testing.assert_allclose(scaled.mean(axis=0), [0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(scaled.std(axis=0), [1.0, 0.0], rtol=1e-15)
