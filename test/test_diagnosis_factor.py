from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import cholesky, solve_triangular

from hgma_compensation.diagnosis.factor import WHOLE, WIDTH, Factor
from hgma_compensation.diagnosis.noise_model import qr_in_place
from hgma_compensation.diagnosis.whitener import MANY, Whitener


def lower(count):
    seconds = np.arange(count)
    covariance = np.exp(-np.abs(seconds[:, None] - seconds) / 50.0) + 0.3 * np.eye(count)
    return cholesky(np.asfortranarray(covariance), lower=True)


@pytest.mark.parametrize("count", [1, WHOLE, WHOLE + 1, 2 * WIDTH + 131, 3 * WIDTH])
@pytest.mark.parametrize("shape", [(), (1,), (2,), (11,)])
def test_panels_solve_as_the_whole_matrix_does(count, shape):
    matrix, columns = lower(count), np.random.default_rng(1).standard_normal((count, *shape))
    factor, whole = Factor(matrix), solve_triangular(matrix, columns, lower=True)
    white = factor.solve(columns)
    assert white.shape == columns.shape
    np.testing.assert_allclose(white, whole, rtol=0.0, atol=1e-12 * np.abs(whole).max())
    assert factor.read().tobytes() == matrix.tobytes()
    assert factor.diagonal.tobytes() == np.diag(matrix).tobytes()


@pytest.mark.parametrize("count", [40, WHOLE + 100])
def test_where_a_factor_is_kept_changes_no_bit(count):
    columns = np.random.default_rng(2).standard_normal((count, 3))
    factor = Factor(lower(count))
    white = factor.solve(columns)
    assert factor.solve(columns, held=False).tobytes() == white.tobytes()
    assert factor.solve(columns).tobytes() == white.tobytes()
    for _ in range(2):
        factor.put_away()
        assert factor.solve(columns).tobytes() == white.tobytes()


def test_what_is_given_is_not_changed():
    columns = np.random.default_rng(3).standard_normal((WHOLE + 100, 3))
    matrix, given = lower(len(columns)), np.asfortranarray(columns)
    before = matrix.tobytes(), given.tobytes()
    Factor(matrix).solve(given)
    assert (matrix.tobytes(), given.tobytes()) == before


@pytest.mark.parametrize("counts", [(30, 70), (WHOLE + 60, 50)])
def test_many_columns_are_whitened_as_few_are(counts):
    edges = np.cumsum((0, *counts))
    places = [np.arange(a, b) for a, b in pairwise(edges)]
    matrices = [lower(count) for count in counts]
    columns = np.random.default_rng(4).standard_normal((edges[-1], 2 * MANY + 5))
    white = Whitener(matrices, places)(columns)
    for matrix, place in zip(matrices, places, strict=True):
        whole = solve_triangular(matrix, columns[place], lower=True)
        np.testing.assert_allclose(white[place], whole, rtol=0.0, atol=1e-12 * np.abs(whole).max())


@pytest.mark.parametrize("count", [40, WHOLE + 100])
def test_expected_energy_is_that_of_the_covariance(count):
    matrix, directions = lower(count), np.linalg.qr(np.random.default_rng(5).standard_normal((count, 7)))[0]
    expected = np.trace(directions.T @ matrix @ matrix.T @ directions)
    assert Whitener([matrix], [np.arange(count)]).expected(directions) == pytest.approx(expected, rel=1e-12)


def test_qr_in_place_is_that_of_numpy():
    columns = np.random.default_rng(6).standard_normal((90, 40))
    ours, theirs = qr_in_place(np.array(columns, order="F")), np.linalg.qr(columns)
    for one, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-13)
