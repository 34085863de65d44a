import numpy as np
import pytest
from builders import make_stamps
from diagnosis_blocks import DAY, flicker_covariance

from hgma_compensation.diagnosis.noise_model import (
    NoiseModel,
    flicker_correlation,
    restricted_log_likelihood,
    slow_cosines,
)

BLOCK = 10.0
COUNTS = (40, 60)
RUN = np.repeat([0, 1], COUNTS)
STAMPS = make_stamps(np.concatenate([np.arange(n) * BLOCK for n in COUNTS]) + RUN * DAY)
CORRELATION = np.array([1.0, 0.5, 0.2, 0.0])


def model():
    random = np.random.default_rng(3)
    count = len(RUN)
    return NoiseModel(random.uniform(0.5, 4.0, count), 0.7, random.uniform(0.0, 1.5, count), CORRELATION, BLOCK)


def covariance_of(noise):
    """Return the covariance (n, n) written out element by element."""
    whole = np.zeros((len(RUN), len(RUN)))
    for number, count in enumerate(COUNTS):
        place = np.flatnonzero(number == RUN)
        own = noise.thermistor[place]
        part = flicker_covariance(count, BLOCK, noise.flicker) + np.diag(noise.white[place])
        lags = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
        part += CORRELATION[np.minimum(lags, 3)] * np.outer(own, own)
        whole[np.ix_(place, place)] = part
    return whole


def test_flicker_is_a_sum_of_relaxations():
    lags = np.arange(300) * BLOCK
    table = flicker_correlation(lags, BLOCK, float(lags[-1]))
    np.testing.assert_allclose(table, flicker_covariance(300, BLOCK, 1.0)[0], rtol=2e-3)


def test_flicker_has_the_same_power_in_each_octave():
    lags = np.arange(4096)
    covariance = flicker_correlation(lags * 1.0, 1.0, 4095.0)
    frequencies = 2.0 ** np.arange(-9, -4.0)
    waves = np.cos(2.0 * np.pi * frequencies[:, None] * lags[1:])
    spectrum = covariance[0] + 2.0 * waves @ covariance[1:]
    np.testing.assert_allclose(spectrum[:-1] / spectrum[1:], 2.0, rtol=0.2)


def test_whitened_samples_have_no_covariance_left():
    noise = model()
    whitener = noise.whitener(RUN, STAMPS)
    left = whitener(whitener(covariance_of(noise)).T)
    np.testing.assert_allclose(left, np.eye(len(RUN)), atol=5e-3)
    samples = np.linalg.cholesky(covariance_of(noise)) @ np.random.default_rng(1).standard_normal((len(RUN), 4000))
    np.testing.assert_allclose(np.cov(whitener(samples)), np.eye(len(RUN)), atol=0.1)


def test_one_column_is_whitened_like_many():
    whitener = model().whitener(RUN, STAMPS)
    columns = np.random.default_rng(2).standard_normal((len(RUN), 3))
    np.testing.assert_allclose(whitener(columns[:, 1]), whitener(columns)[:, 1], atol=1e-12)


def test_a_spread_widens_the_covariance_inside_each_run():
    noise = model()
    spread = np.random.default_rng(4).standard_normal((len(RUN), 2))
    whitener = noise.whitener(RUN, STAMPS, spread)
    inside = RUN[:, None] == RUN[None, :]
    left = whitener(whitener(covariance_of(noise) + inside * (spread @ spread.T)).T)
    np.testing.assert_allclose(left, np.eye(len(RUN)), atol=5e-3)


def test_determinant_and_likelihood_are_those_of_the_covariance():
    noise, random = model(), np.random.default_rng(6)
    covariance, whitener = covariance_of(noise), noise.whitener(RUN, STAMPS)
    assert whitener.log_determinant == pytest.approx(np.linalg.slogdet(covariance)[1], abs=0.05)
    target, nuisance = random.standard_normal(len(RUN)), random.standard_normal((len(RUN), 4))
    inverse = np.linalg.inv(covariance)
    gram = nuisance.T @ inverse @ nuisance
    left = target - nuisance @ np.linalg.solve(gram, nuisance.T @ inverse @ target)
    expected = -0.5 * (np.linalg.slogdet(covariance)[1] + np.linalg.slogdet(gram)[1] + left @ inverse @ left)
    likelihood = restricted_log_likelihood(whitener, target, nuisance)
    assert likelihood == pytest.approx(expected, abs=0.1)
    moved = restricted_log_likelihood(whitener, target + nuisance @ np.array([5.0, -3.0, 2.0, 100.0]), nuisance)
    assert moved == pytest.approx(likelihood, abs=1e-6)


def test_slow_cosines_belong_to_one_run_each_and_end_at_the_shortest_period():
    cosines = slow_cosines(RUN, STAMPS, 100.0)
    lengths = [(count - 1) * BLOCK for count in COUNTS]
    counts = [1 + int(2.0 * length / 100.0) for length in lengths]
    assert cosines.shape == (len(RUN), sum(counts))
    assert not cosines[RUN == 1, : counts[0]].any()
    assert not cosines[RUN == 0, counts[0] :].any()
    np.testing.assert_array_equal(cosines[RUN == 0, 0], 1.0)
    fastest = cosines[RUN == 0, counts[0] - 1]
    assert np.sum(np.diff(np.sign(fastest)) != 0) == counts[0] - 1


def test_slow_cosines_of_a_single_run_are_those_that_it_has_beside_others():
    cosines = slow_cosines(RUN, STAMPS, 100.0)
    start = 0
    for number in (0, 1):
        alone = slow_cosines(RUN[number == RUN], STAMPS[number == RUN], 100.0)
        assert alone.flags.c_contiguous
        np.testing.assert_array_equal(alone, cosines[number == RUN, start : start + alone.shape[1]])
        start += alone.shape[1]
