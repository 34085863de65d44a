import numpy as np
import pytest
from scipy.stats import multivariate_normal

from hgma_compensation.diagnosis.evidence import FLAT, LEFT_OUT, UNTIED, average, posterior

COUNT = 120


def data(seed=1, noise=1.0, size=2.0):
    """Return columns (n, 12), of which the first six carry the target and the last six do not."""
    random = np.random.default_rng(seed)
    columns = random.standard_normal((COUNT, 12))
    weights = np.concatenate([size * random.standard_normal(6), np.zeros(6)])
    return columns, columns @ weights + noise * random.standard_normal(COUNT), weights


def marginal(columns, target, prior):
    """Return the log density of a target under white noise of variance 1 and weights of a prior variance (k,)."""
    covariance = np.eye(len(target)) + (columns * prior) @ columns.T
    return multivariate_normal(np.zeros(len(target)), covariance).logpdf(target) + 0.5 * len(target) * np.log(2 * np.pi)


def flat_prior(columns, target):
    """Return the prior variance of untied columns: FLAT times the target's, of a column of RMS 1."""
    return FLAT * np.mean(target**2) / np.mean(columns**2, axis=0)


def test_with_columns_that_are_not_tied_it_is_the_closed_form_of_ridge():
    columns, target, _ = data()
    columns = columns * np.geomspace(0.01, 100.0, 12)
    found = posterior(columns, target, [UNTIED] * 12)
    prior = flat_prior(columns, target)
    covariance = np.linalg.inv(columns.T @ columns + np.diag(1.0 / prior))
    np.testing.assert_allclose(found.weights, covariance @ columns.T @ target, rtol=1e-6)
    np.testing.assert_allclose(found.covariance, covariance, rtol=1e-6, atol=1e-12 * covariance.max())
    assert found.log_evidence == pytest.approx(marginal(columns, target, prior), abs=1e-4)
    predicted = found.deviation(columns[:5])
    np.testing.assert_allclose(predicted**2, np.diag(columns[:5] @ covariance @ columns[:5].T), rtol=1e-6)


@pytest.mark.parametrize("size", [0.05, 0.5, 5.0])
def test_the_width_of_a_group_is_the_one_of_greatest_evidence(size):
    columns, target, _ = data(seed=2, size=size)
    found = posterior(columns, target, [0] * 12)
    widths = np.geomspace(1e-6, 1e3, 400)
    # The group shares one width, counted at the mean scale of its columns.
    share = np.mean(np.linalg.norm(columns, axis=0)) / np.sqrt(COUNT)
    evidence = np.array([marginal(columns, target, np.full(12, w)) for w in widths])
    assert found.log_evidence == pytest.approx(evidence.max(), abs=0.3)
    best = widths[np.argmax(evidence)]
    if size >= 0.5:
        assert np.mean(found.weights**2) * share**2 == pytest.approx(best, rel=0.4)
        ridge = np.linalg.solve(columns.T @ columns + np.eye(12) / best, columns.T @ target)
        np.testing.assert_allclose(found.weights, ridge, atol=0.02 * np.abs(ridge).max())


def test_weights_of_a_group_that_carries_nothing_are_tied_down():
    columns, target, weights = data(seed=3, noise=1.0)
    found = posterior(columns, target, [0] * 6 + [1] * 6)
    free = np.linalg.lstsq(columns, target, rcond=None)[0]
    assert np.linalg.norm(found.weights[6:]) < 0.5 * np.linalg.norm(free[6:])
    np.testing.assert_allclose(found.weights[:6], weights[:6], atol=0.4)


def test_left_out_columns_have_no_weight_and_change_nothing():
    columns, target, _ = data(seed=4)
    whole = posterior(columns, target, [0] * 6 + [LEFT_OUT] * 6)
    part = posterior(columns[:, :6], target, [0] * 6)
    np.testing.assert_allclose(whole.weights[6:], 0.0, atol=1e-9)
    np.testing.assert_allclose(whole.weights[:6], part.weights, rtol=1e-6)
    assert whole.log_evidence == pytest.approx(part.log_evidence, abs=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_evidence_prefers_the_group_that_carries_the_target(seed):
    columns, target, _ = data(seed=seed, size=1.0)
    true, false, none = (
        posterior(columns, target, groups).log_evidence
        for groups in ([0] * 6 + [LEFT_OUT] * 6, [LEFT_OUT] * 6 + [0] * 6, [LEFT_OUT] * 12)
    )
    both = posterior(columns, target, [0] * 6 + [1] * 6).log_evidence
    assert true > false + 10.0
    assert true > none + 10.0
    # A group that may have no width costs little, and never gains much.
    assert abs(both - true) < 3.0


def test_evidence_needs_more_than_noise_to_prefer_a_group():
    random = np.random.default_rng(8)
    gains = []
    for _ in range(20):
        columns, target = random.standard_normal((COUNT, 6)), random.standard_normal(COUNT)
        with_, without = (posterior(columns, target, [group] * 6).log_evidence for group in (0, LEFT_OUT))
        gains.append(with_ - without)
    assert max(gains) < 5.0
    assert np.median(gains) < 1.0


def test_an_average_has_the_moments_of_the_mixture():
    columns, target, _ = data(seed=5)
    models = [posterior(columns, target, groups) for groups in ([0] * 12, [0] * 6 + [LEFT_OUT] * 6)]
    shares = (0.3, 0.7)
    mean, root = average(list(zip(shares, models, strict=True)))
    np.testing.assert_allclose(mean, 0.3 * models[0].weights + 0.7 * models[1].weights)
    second = sum(s * (m.covariance + np.outer(m.weights, m.weights)) for s, m in zip(shares, models, strict=True))
    np.testing.assert_allclose(root @ root.T, second - np.outer(mean, mean), atol=1e-10)
    apart = models[0].weights - models[1].weights
    assert apart @ (root @ root.T) @ apart > apart @ (0.3 * models[0].covariance + 0.7 * models[1].covariance) @ apart
