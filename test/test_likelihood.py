import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from hgma_compensation.training.likelihood import marginal_error

SEED, SAMPLES, PENALISED, FREE = 20190725, 60, 3, 2
VAGUE = 1e-9
"""Penalty of the free columns: a prior so wide that its width is the same constant for every candidate."""


def candidate(seed):
    random = np.random.default_rng(seed)
    columns = random.standard_normal((SAMPLES, PENALISED + FREE))
    target = columns @ random.standard_normal(PENALISED + FREE) + 0.3 * random.standard_normal(SAMPLES)
    penalty = np.r_[np.exp(random.uniform(np.log(1e-5), 0.0, PENALISED)), np.full(FREE, VAGUE)]
    return columns, target, penalty


def log_density(columns, target, penalty, variance):
    """Return log p(y) of y = Φw + e itself, without a factorisation by weights."""
    prior = variance / (SAMPLES * penalty)
    covariance = (columns * prior) @ columns.T + variance * np.eye(SAMPLES)
    return multivariate_normal(np.zeros(SAMPLES), covariance).logpdf(target)


def likeliest_log_density(columns, target, penalty):
    """Return log p(y) at its greatest over the noise, the free columns' prior of a fixed width taken out of it."""
    grid = np.exp(np.linspace(np.log(1e-3), np.log(10.0), 4001))
    # The density of the free weights is flat: only its scale, in units of the noise, depends on the variance.
    return max(log_density(columns, target, penalty, v) + 0.5 * FREE * np.log(v) for v in grid)


def of_one(columns, target, penalty):
    return float(marginal_error(columns[None], target, penalty[None], PENALISED)[0])


def test_difference_of_two_candidates_is_that_of_the_normal_density_itself():
    columns, target, penalty = candidate(SEED)
    other = columns.copy()
    other[:, :PENALISED] += 0.3 * np.random.default_rng(SEED + 1).standard_normal((SAMPLES, PENALISED))
    stronger = np.r_[10.0 * penalty[:PENALISED], penalty[PENALISED:]]
    ours = [-(SAMPLES - FREE) * np.log(of_one(c, target, p)) for c, p in ((columns, penalty), (other, stronger))]
    truth = [likeliest_log_density(columns, target, penalty), likeliest_log_density(other, target, stronger)]
    assert abs(truth[0] - truth[1]) > 1.0
    assert ours[0] - ours[1] == pytest.approx(truth[0] - truth[1], abs=1e-3)


def test_unit_of_the_target_is_the_unit_of_the_error():
    columns, target, penalty = candidate(SEED)
    assert of_one(columns, 1024.0 * target, penalty) == pytest.approx(1024.0 * of_one(columns, target, penalty))


def test_a_column_of_noise_is_paid_for():
    """Least squares would always prefer it: what it takes off the rest must be more than it costs."""
    random = np.random.default_rng(SEED)
    line = np.column_stack([np.linspace(-1.0, 1.0, SAMPLES), np.ones(SAMPLES)])
    target = line @ [3.0, 1.0] + 0.3 * random.standard_normal(SAMPLES)
    penalty = np.full((1, 3), 1e-3)
    errors = []
    for _ in range(20):
        columns = np.column_stack([random.standard_normal(SAMPLES), line])[None]
        with_noise = marginal_error(columns, target, penalty, 1)
        errors.append(float(with_noise[0] / marginal_error(columns[:, :, 1:], target, penalty[:, 1:], 0)[0]))
    assert np.mean(np.array(errors) > 1.0) >= 0.8


@given(st.integers(0, 2**32 - 1), st.integers(1, 5))
def test_a_candidate_hears_nothing_of_the_others(seed, count):
    many = [candidate([seed, number]) for number in range(count)]
    target = many[0][1]
    together = marginal_error(
        np.stack([columns for columns, _, _ in many]), target, np.stack([penalty for _, _, penalty in many]), PENALISED
    )
    alone = [of_one(columns, target, penalty) for columns, _, penalty in many]
    np.testing.assert_array_equal(together, alone)


def test_target_of_zeros_is_neither_infinite_nor_nan():
    columns, target, penalty = candidate(SEED)
    assert np.isfinite(of_one(columns, np.zeros_like(target), penalty))
