from math import inf, sqrt

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from scipy.stats import chi2

from hgma_compensation.temperature.trend_filter import INITIAL_RATE_SIGMA, TrendFilter, TrendNoise

NOISE = TrendNoise(process=1e-6, measurement=4e-4)
SEED = 20190725


def process_covariance(q, dt):
    return q * np.array([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]])


def simulate(seed, count):
    """Draw irregular steps and samples from the very model of the filter, exactly discretised."""
    random = np.random.default_rng(seed)
    steps = np.r_[0.0, random.uniform(0.2, 3.0, count - 1)]
    state, samples = np.array([20.0, INITIAL_RATE_SIGMA * random.standard_normal()]), np.empty(count)
    for k, dt in enumerate(steps):
        if k:
            root = np.linalg.cholesky(process_covariance(NOISE.process, dt))
            state = np.array([[1.0, dt], [0.0, 1.0]]) @ state + root @ random.standard_normal(2)
        samples[k] = state[0] + sqrt(NOISE.measurement) * random.standard_normal()
    return steps, samples


def settling_time(dt):
    # The continuous filter's poles lie at ω e^(±i3π/4), ω = (q / (r dt))^(1/4); 30 time constants leave e^-30 < 1e-12.
    return 30.0 * sqrt(2.0) * (NOISE.measurement * dt / NOISE.process) ** 0.25


def test_equals_filterpy_on_irregular_stamps():
    steps, samples = simulate(SEED, 500)
    ours, theirs = [], []
    trend, kalman = TrendFilter(NOISE), KalmanFilter(dim_x=2, dim_z=1)
    kalman.H, kalman.R = np.array([[1.0, 0.0]]), np.array([[NOISE.measurement]])
    for k, (dt, sample) in enumerate(zip(steps.tolist(), samples.tolist(), strict=True)):
        step = trend.step(dt, sample)
        if k == 0:
            kalman.x = np.array([[sample], [0.0]])
            kalman.P = np.diag([NOISE.measurement, INITIAL_RATE_SIGMA**2])
            continue
        kalman.predict(F=np.array([[1.0, dt], [0.0, 1.0]]), Q=process_covariance(NOISE.process, dt))
        kalman.update(sample)
        ours.append([step.temperature, step.rate, step.innovation, step.innovation_variance])
        theirs.append([kalman.x[0, 0], kalman.x[1, 0], kalman.y[0, 0], kalman.S[0, 0]])
    for got, expected in zip(np.array(ours).T, np.array(theirs).T, strict=True):
        np.testing.assert_allclose(got, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(np.array(ours)[:, 3], np.array(theirs)[:, 3], rtol=1e-9)


def test_first_sample_starts_it_and_brings_no_innovation():
    step = TrendFilter(NOISE).step(0.0, 21.5)
    assert (step.temperature, step.rate, step.innovation, step.innovation_variance) == (21.5, 0.0, 0.0, inf)


def test_constant_temperature_converges_after_a_wrong_start():
    trend, dt = TrendFilter(NOISE), 1.0
    trend.step(0.0, 30.0)
    for _ in range(int(settling_time(dt) / dt)):
        step = trend.step(dt, 20.0)
    assert step.temperature == pytest.approx(20.0, abs=1e-9)
    assert step.rate == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("rate", [-0.5, 0.02])
def test_rate_of_a_ramp_is_recovered_without_lag(rate):
    trend, dt = TrendFilter(NOISE), 0.5
    count = int(settling_time(dt) / dt)
    for k in range(count):
        step = trend.step(dt, -10.0 + rate * k * dt)
    assert step.rate == pytest.approx(rate, abs=1e-9)
    assert step.temperature == pytest.approx(-10.0 + rate * (count - 1) * dt, abs=1e-9)


def test_innovations_are_white_with_the_predicted_variance():
    trend = TrendFilter(NOISE)
    steps = [trend.step(dt, sample) for dt, sample in zip(*simulate(SEED, 4000), strict=True)][1:]
    normalised = np.array([step.innovation / sqrt(step.innovation_variance) for step in steps])
    low, high = chi2.interval(0.999, len(normalised))
    assert low < np.sum(normalised**2) < high
    lags = np.arange(1, 11)
    correlations = np.array([normalised[k:] @ normalised[:-k] for k in lags]) / (normalised @ normalised)
    n = len(normalised)
    ljung_box = n * (n + 2) * np.sum(correlations**2 / (n - lags))
    assert ljung_box < chi2.ppf(0.999, len(lags))


def test_reset_forgets_every_sample():
    steps, samples = simulate(SEED, 50)
    used, fresh = TrendFilter(NOISE), TrendFilter(NOISE)
    for dt, sample in zip(steps, samples, strict=True):
        used.step(dt, sample + 3.0)
    used.reset()
    for dt, sample in zip(steps, samples, strict=True):
        assert used.step(dt, sample) == fresh.step(dt, sample)
