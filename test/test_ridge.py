import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.linear_model import Ridge

from hgma_compensation.training.ridge import LeftOutFolds, cross_validated_rms, solve_ridge

SEED = 20190725


@pytest.fixture
def problem():
    """Columns of a population of four (4, 120, 6), a target, penalties, and five folds in random order."""
    random = np.random.default_rng(SEED)
    columns = random.standard_normal((4, 120, 6))
    columns[..., 1] = columns[..., 0] + 0.1 * columns[..., 1]
    target = columns[0] @ random.standard_normal(6) + 0.3 * random.standard_normal(120)
    return columns, target, 10.0 ** random.uniform(-6.0, 0.0, (4, 6)), random.permutation(np.arange(120) % 5)


def test_equals_the_normal_equations(problem):
    columns, target, penalty, _ = problem
    gram = columns[0].T @ columns[0] + len(target) * np.diag(penalty[0])
    np.testing.assert_allclose(
        solve_ridge(columns[0], target, penalty[0]), np.linalg.solve(gram, columns[0].T @ target), rtol=1e-10
    )


@pytest.mark.parametrize("penalty", [1e-6, 1e-2, 10.0])
def test_equals_scikit_learn(problem, penalty):
    columns, target, _, _ = problem
    # Its penalty is of the sum over all samples, ours of one.
    theirs = Ridge(alpha=penalty * len(target), fit_intercept=False, solver="svd").fit(columns[0], target).coef_
    np.testing.assert_allclose(solve_ridge(columns[0], target, np.full(6, penalty)), theirs, rtol=1e-10)


def test_no_penalty_is_least_squares(problem):
    columns, target, _, _ = problem
    weights = solve_ridge(columns[0], target, np.zeros(6))
    np.testing.assert_allclose(columns[0].T @ (target - columns[0] @ weights), np.zeros(6), atol=1e-10)


def test_equal_columns_share_the_weight(problem):
    columns, target, _, _ = problem
    twice = np.column_stack([columns[0], columns[0][:, 0]])
    weights = solve_ridge(twice, target, np.full(7, 1e-9))
    assert weights[0] == pytest.approx(weights[6], rel=1e-6)
    single = solve_ridge(columns[0], target, np.full(6, 1e-9))
    assert weights[0] + weights[6] == pytest.approx(single[0], rel=1e-6)


def test_cross_validation_equals_refits_without_each_fold(problem):
    columns, target, penalty, folds = problem
    expected = []
    for candidate, own_penalty in zip(columns, penalty, strict=True):
        error = np.empty(len(target))
        for fold in range(5):
            out = folds == fold
            weights = solve_ridge(candidate[~out], target[~out], own_penalty)
            error[out] = target[out] - candidate[out] @ weights
        expected.append(np.sqrt(np.mean(error**2)))
    np.testing.assert_allclose(cross_validated_rms(columns, target, penalty, folds), expected, rtol=1e-6)


def test_population_is_one_candidate_after_the_other(problem):
    columns, target, penalty, folds = problem
    single = [cross_validated_rms(c[None], target, p[None], folds)[0] for c, p in zip(columns, penalty, strict=True)]
    np.testing.assert_allclose(cross_validated_rms(columns, target, penalty, folds), single, rtol=1e-12)


@given(seed=st.integers(0, 2**32 - 1), size=st.integers(1, 9), folds=st.integers(2, 6))
def test_fitness_is_the_same_bits_whatever_is_evaluated_beside_it(seed, size, folds):
    random = np.random.default_rng(seed)
    rows = LeftOutFolds.of(np.sort(random.integers(0, folds, 90)) if seed % 2 else random.permutation(90) % folds)
    columns, target = random.standard_normal((9, 90, 5)), random.standard_normal(90)
    penalty = 10.0 ** random.uniform(-6.0, 0.0, (9, 5))
    whole = rows.rms(columns, target, penalty)
    starts = range(0, 9, size)
    parts = [rows.rms(columns[a : a + size], target, penalty[a : a + size]) for a in starts]
    assert np.concatenate(parts).tobytes() == whole.tobytes()


def test_rows_are_sorted_fold_by_fold_and_keep_their_order_within():
    sorted_rows = LeftOutFolds.of(np.array([2, 0, 1, 0, 2, 2]))
    np.testing.assert_array_equal(sorted_rows.order, [1, 3, 2, 0, 4, 5])
    assert sorted_rows.places == (slice(0, 2), slice(2, 3), slice(3, 6))


def test_columns_that_explain_one_fold_only_do_not_help_to_predict_it(problem):
    _, target, _, folds = problem
    marks = (folds[:, None] == np.arange(5)).astype(float)
    rms = cross_validated_rms(marks[None], target, np.full((1, 5), 1e-9), folds)[0]
    assert rms == pytest.approx(np.sqrt(np.mean(target**2)), rel=1e-12)
