import numpy as np
import pytest
from builders import make_stamps

from hgma_compensation.diagnosis.smoothing import smooth, thinned
from hgma_compensation.temperature.trend_filter import INITIAL_RATE_SIGMA, TrendFilter, TrendNoise

NOISE = TrendNoise(process=1e-5, measurement=4e-4)


def direct(seconds, values, noise):
    """Return mean (m, 2) and covariance (m, 2, 2) of (T, Ṫ) by one generalised least squares over all states."""
    count = len(seconds)
    rows, targets = [], []

    def add(matrix, target, covariance):
        root = np.linalg.cholesky(np.linalg.inv(covariance)).T
        rows.append(root @ matrix)
        targets.append(root @ target)

    def place(index, block):
        matrix = np.zeros((len(block), 2 * count))
        matrix[:, 2 * index : 2 * index + block.shape[1]] = block
        return matrix

    add(place(0, np.array([[0.0, 1.0]])), np.zeros(1), np.array([[INITIAL_RATE_SIGMA**2]]))
    for k, dt in enumerate(np.diff(seconds)):
        moved = np.array([[-1.0, -dt, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]])
        driven = noise.process * np.array([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]])
        add(place(k, moved), np.zeros(2), driven)
    for k, value in enumerate(values):
        add(place(k, np.array([[1.0, 0.0]])), np.array([value]), np.array([[noise.measurement]]))
    matrix, target = np.vstack(rows), np.concatenate(targets)
    covariance = np.linalg.inv(matrix.T @ matrix)
    states = covariance @ matrix.T @ target
    blocks = [covariance[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] for k in range(count)]
    return states.reshape(count, 2), np.array(blocks)


def test_smoothing_is_the_least_squares_fit_of_all_states_at_once():
    random = np.random.default_rng(2)
    seconds = np.cumsum(random.choice([0.5, 1.0, 2.0, 15.0], 25))
    values = 20.0 + 0.05 * seconds + 0.3 * random.standard_normal(25)
    noise = TrendNoise(process=1e-3, measurement=0.04)
    smoothed = smooth(make_stamps(seconds), values, noise)
    states, covariance = direct(seconds, values, noise)
    np.testing.assert_allclose(smoothed.temperature, states[:, 0], rtol=1e-8)
    np.testing.assert_allclose(smoothed.rate, states[:, 1], atol=1e-8)
    np.testing.assert_allclose(smoothed.variance, covariance[:, 0, 0], rtol=1e-6)


def test_a_corner_is_as_round_before_as_after_whereas_a_filter_trails():
    seconds = np.arange(1200.0)
    corner = np.where(seconds < 600.0, 0.05 * (seconds - 600.0), 0.0)
    smoothed = smooth(make_stamps(seconds), corner, NOISE).temperature
    # The other way round in time: a lag would change its sign.
    backwards = smooth(make_stamps(seconds), corner[::-1].copy(), NOISE).temperature[::-1]
    middle = slice(300, 900)
    np.testing.assert_allclose(smoothed[middle], backwards[middle], atol=1e-6)
    rounded = (smoothed - corner)[middle]
    assert np.abs(rounded).max() > 1e-3
    assert rounded @ (seconds[middle] - 600.0) == pytest.approx(0.0, abs=0.02 * np.abs(rounded).sum() * 20.0)
    trend = TrendFilter(NOISE)
    filtered = np.array([trend.step(1.0, float(value)).temperature for value in corner])
    trailing = (filtered - corner)[middle]
    assert trailing @ (seconds[middle] - 600.0) > 5.0 * np.abs(rounded @ (seconds[middle] - 600.0))


def test_a_ramp_without_noise_is_met():
    seconds = np.arange(600.0)
    smoothed = smooth(make_stamps(seconds), 10.0 + 0.05 * seconds, NOISE)
    np.testing.assert_allclose(smoothed.temperature[200:400], 10.0 + 0.05 * seconds[200:400], atol=1e-6)
    np.testing.assert_allclose(smoothed.rate[200:400], 0.05, atol=1e-6)


def test_the_variance_is_that_of_the_error():
    random = np.random.default_rng(5)
    count, draws = 60, 400
    q, r = 1e-4, 0.01
    steps = np.linalg.cholesky(q * np.array([[1.0 / 3.0, 0.5], [0.5, 1.0]]))
    errors = np.empty((draws, count))
    for draw in range(draws):
        state = np.array([20.0, INITIAL_RATE_SIGMA * random.standard_normal()])
        truth = np.empty(count)
        for k in range(count):
            truth[k] = state[0]
            state = np.array([state[0] + state[1], state[1]]) + steps @ random.standard_normal(2)
        measured = truth + np.sqrt(r) * random.standard_normal(count)
        smoothed = smooth(make_stamps(np.arange(count)), measured, TrendNoise(q, r))
        errors[draw] = smoothed.temperature - truth
    np.testing.assert_allclose(np.mean(errors**2, axis=0), smoothed.variance, rtol=0.35)
    assert np.mean(errors**2 / smoothed.variance) == pytest.approx(1.0, rel=0.05)
    assert smoothed.variance[30] < 0.5 * smoothed.variance[0]


def test_a_fast_thermistor_is_averaged_over_a_second_with_less_noise():
    seconds = np.arange(0.0, 100.0, 0.1)
    stamps, means, noise = thinned(make_stamps(seconds), 0.02 * seconds, NOISE)
    assert len(stamps) == 100
    np.testing.assert_allclose((stamps - stamps[0]) * 1e-9, np.arange(100.0), atol=1e-6)
    np.testing.assert_allclose(means, 0.02 * (np.arange(100.0) + 0.45), atol=1e-9)
    assert (noise.process, noise.measurement) == (NOISE.process, NOISE.measurement / 10.0)


@pytest.mark.parametrize("interval", [0.6, 1.0, 7.0])
def test_a_slow_thermistor_is_taken_as_it_is(interval):
    stamps, values = make_stamps(np.arange(50) * interval), np.arange(50.0)
    same = thinned(stamps, values, NOISE)
    assert same[0] is stamps
    assert same[1] is values
    assert same[2] is NOISE
