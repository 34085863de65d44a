"""The Kalman stage as filterpy sees it: the design that the stage's own scalar code is held to."""

from dataclasses import dataclass

import numpy as np
from filterpy.kalman import KalmanFilter

from hgma_compensation.kalman.random_walk import RandomWalkNoise

MOST_STEPS = 100_000
SETTLED = 1e-12
"""Relative change of the variance from one step to the next."""


@dataclass(frozen=True)
class SettledFilter:
    """Behaviour after the start: gain K, time constant (s), and the factor by which white noise shrinks."""

    gain: float
    time_constant: float
    noise_reduction: float


def reference_filter(noise: RandomWalkNoise, interval: float, first: float = 0.0) -> KalmanFilter:
    """Return the random-walk filter, Eqs. (7) to (11), for samples at an even interval (s), after the first."""
    sample_variance = noise.white**2 / interval
    reference = KalmanFilter(dim_x=1, dim_z=1)
    reference.x = np.array([[first]])
    reference.P = np.array([[sample_variance]])
    reference.F = np.array([[1.0]])
    reference.H = np.array([[1.0]])
    reference.Q = np.array([[noise.walk**2 * interval]])
    reference.R = np.array([[sample_variance]])
    return reference


def settled_filter(noise: RandomWalkNoise, interval: float) -> SettledFilter:
    """Return what the filter does once its gain has settled, found by running it.

    A first-order low-pass with gain K passes white noise with the variance K / (2 - K).
    """
    reference = reference_filter(noise, interval)
    for _ in range(MOST_STEPS):
        before = float(reference.P[0, 0])
        reference.predict()
        reference.update(np.zeros((1, 1)))
        if abs(float(reference.P[0, 0]) - before) <= SETTLED * before:
            break
    gain = float(reference.K[0, 0])
    return SettledFilter(gain, -interval / np.log1p(-gain) if gain < 1.0 else 0.0, float(np.sqrt((2.0 - gain) / gain)))
