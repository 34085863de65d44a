from math import exp, sqrt

import numpy as np
import pytest
from builders import make_stamps
from filterpy.kalman import KalmanFilter

from hgma_compensation.kalman.course import filter_samples
from hgma_compensation.kalman.random_walk import RandomWalkNoise

SEED = 20190725
NOISE = RandomWalkNoise(white=0.3, walk=0.05)


def samples(count, seed=SEED):
    random = np.random.default_rng(seed)
    stamps = make_stamps(np.cumsum(random.uniform(0.001, 0.5, count)))
    return stamps, 9.81 + np.cumsum(0.02 * random.standard_normal(count)) + 0.5 * random.standard_normal(count)


def steady_gain(noise, dt):
    """Root of the scalar Riccati equation: P² = Q (P + R) for the predicted variance P."""
    r, q = noise.white**2 / dt, noise.walk**2 * dt
    predicted = 0.5 * (q + sqrt(q * q + 4.0 * q * r))
    return predicted / (predicted + r)


def test_equals_filterpy_on_irregular_stamps():
    stamps, values = samples(500)
    estimates, innovations = filter_samples(NOISE, stamps, values)
    kalman = KalmanFilter(dim_x=1, dim_z=1)
    kalman.x, kalman.H = np.array([[values[0]]]), np.array([[1.0]])
    steps = np.diff(stamps) * 1e-9
    kalman.P = np.array([[NOISE.white**2 / steps[0]]])  # the first sample is given the noise of the second
    expected = [[values[0], 0.0]]
    for dt, value in zip(steps, values[1:], strict=True):
        kalman.predict(F=np.eye(1), Q=np.array([[NOISE.walk**2 * dt]]))
        kalman.update(value, R=np.array([[NOISE.white**2 / dt]]))
        expected.append([kalman.x[0, 0], kalman.y[0, 0]])
    expected_estimates, expected_innovations = np.array(expected).T
    np.testing.assert_allclose(estimates, expected_estimates, rtol=1e-12)
    # An innovation is a difference of numbers near 10: the same rounding, absolute.
    np.testing.assert_allclose(innovations, expected_innovations, rtol=0.0, atol=1e-12 * np.abs(values).max())


@pytest.mark.parametrize("dt", [0.001, 0.1, 5.0])
def test_settled_gain_is_the_analytic_one(dt):
    gain = steady_gain(NOISE, dt)
    # The error of the gain shrinks by (1 - gain)² with each step: e^-40 of it is left.
    count = 2 + int(40.0 / (2.0 * gain))
    stamps = make_stamps(dt * np.arange(count + 1))
    estimates, innovations = filter_samples(NOISE, stamps, np.r_[np.zeros(count), 1.0])
    assert innovations[-1] == 1.0
    assert estimates[-1] == pytest.approx(gain, rel=1e-9)


@pytest.mark.parametrize("seconds", [0.5, 20.0])
def test_time_constant_is_that_of_the_step_response(seconds):
    dt = seconds / 200.0
    noise = RandomWalkNoise.with_time_constant(white=0.3, seconds=seconds)
    # The gain is ε - ε²/2 + O(ε³) with ε = dt / seconds, hence (1 - gain)^(1/ε) = 1/e within ε².
    settle, rise = 200 * 20, 200
    stamps = make_stamps(dt * np.arange(settle + rise))
    estimates, _ = filter_samples(noise, stamps, np.r_[np.zeros(settle), np.ones(rise)])
    assert estimates[-1] == pytest.approx(1.0 - exp(-1.0), abs=(1.0 / 200.0) ** 2)
