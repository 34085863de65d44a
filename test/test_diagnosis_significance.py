import numpy as np
import pytest
from diagnosis_blocks import no_whitening
from scipy.stats import chi2, kstest

from hgma_compensation.diagnosis.search import Projection
from hgma_compensation.diagnosis.significance import null_maxima, score_of

COUNT = 300


@pytest.fixture(scope="module")
def known():
    return np.random.default_rng(1).standard_normal((COUNT, 8))


@pytest.fixture(scope="module")
def directions(known):
    """Forty candidates of one to three columns, some of them alike."""
    random = np.random.default_rng(2)
    projection = Projection.of(no_whitening(COUNT), known, np.zeros(COUNT))
    base = random.standard_normal((COUNT, 40))
    candidates = [base[:, k : k + 1 + k % 3] + 0.2 * base[:, :1] for k in range(38)]
    return [projection.directions(columns) for columns in candidates]


def best_score(projection, directions):
    return max(float(score_of(np.sum((q.T @ projection.residual) ** 2), q.shape[1])) for q in directions)


@pytest.fixture(scope="module")
def null(known, directions):
    projection = Projection.of(no_whitening(COUNT), known, np.zeros(COUNT))
    return null_maxima(projection, directions, np.random.default_rng(3), 400)


def test_on_noise_p_values_are_spread_evenly(known, directions, null):
    random = np.random.default_rng(4)
    p_values = []
    for _ in range(100):
        target = random.standard_normal(COUNT) + known @ random.standard_normal(8)
        projection = Projection.of(no_whitening(COUNT), known, target)
        p_values.append(null.p_value(best_score(projection, directions)))
    assert np.sum(np.array(p_values) < 0.05) <= 11
    assert min(p_values) > 1e-4
    assert kstest(p_values, "uniform").pvalue > 1e-3


def test_an_effect_that_is_there_is_rare_on_noise(known, directions, null):
    target = np.random.default_rng(5).standard_normal(COUNT) + 8.0 * directions[7][:, 0]
    projection = Projection.of(no_whitening(COUNT), known, target)
    assert null.p_value(best_score(projection, directions)) < 1e-5


def test_greater_scores_are_rarer(null):
    scores = np.linspace(0.0, 30.0, 600)
    p_values = np.array([null.p_value(float(score)) for score in scores])
    assert (np.diff(p_values) <= 1e-12).all()
    assert p_values[0] == 1.0
    assert 0.0 < p_values[-1] < 1e-10


def test_a_score_is_the_chi_squared_probability_in_decades():
    for rank in (1, 2, 7):
        assert score_of(float(chi2.isf(1e-3, rank)), rank) == pytest.approx(3.0)
        assert score_of(2.5 * float(chi2.isf(1e-3, rank)), rank, 2.5) == pytest.approx(3.0)
    # Where the probability itself is no number any more, the score is only large.
    assert score_of(5000.0, 1) > 300.0
    assert score_of(10.0, 1) > score_of(10.0, 5)
