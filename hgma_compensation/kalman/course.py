"""The random-walk filter over many samples that are all taken in; every bit as RandomWalkFilter one by one."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.intervals import Steps, hold_steps
from hgma_compensation.kalman.low_pass import low_pass
from hgma_compensation.kalman.random_walk import RandomWalkFilter, RandomWalkNoise, kalman_gain
from hgma_compensation.stamps import Stamps, seconds_between

Array = NDArray[np.float64]


class Course(NamedTuple):
    """Estimates and their variances before the first sample and after each, (n + 1,), and of the innovations, (n,).

    Variances that stay are one number.
    """

    estimates: Array
    variances: float | Array
    innovation_variances: float | Array


def course(level: RandomWalkFilter, steps: Steps, samples: Array) -> Course:
    """Return what a filter whose variance is known does over samples (n,), each of them with dt > 0."""
    variance = level.variance
    assert variance is not None
    dt, averaged = steps
    if isinstance(dt, float) and isinstance(averaged, float):
        sample_variance, predicted = level.sample_variance(averaged), variance + level.added_variance(dt)
        gain = kalman_gain(predicted, sample_variance)
        if gain * sample_variance == variance:
            estimates = low_pass(level.estimate, 1.0 - gain, samples)
            return Course(estimates, variance, predicted + sample_variance)
    dt, averaged = steps.each(len(samples))
    added, sample_variances = level.added_variance(dt), level.sample_variance(averaged)
    variances = riccati(variance, added, sample_variances)
    predicted_variances = variances[:-1] + added
    gains = kalman_gain(predicted_variances, sample_variances)
    estimates = low_pass(level.estimate, 1.0 - gains, samples)
    return Course(estimates, variances, predicted_variances + sample_variances)


def riccati(variance: float, added: Array, sample_variances: Array) -> Array:
    """Return the variance before the first and after each of n samples, (n + 1,)."""
    variances = [variance]
    append = variances.append
    for walk, white in zip(added.tolist(), sample_variances.tolist(), strict=True):
        variance = kalman_gain(variance + walk, white) * white
        append(variance)
    return np.array(variances)


def filter_samples(noise: RandomWalkNoise, stamps: Stamps, measured: Array) -> tuple[Array, Array]:
    """Return estimates and innovations, each (n,), of the plain filter over measurements (n,) at growing stamps (ns).

    No gate: real acceleration is smoothed away with the noise. For comparison, and for records at rest.
    """
    dt = seconds_between(hold_steps(np.diff(stamps)), 0)
    level = RandomWalkFilter(noise)
    level.start(float(measured[0]), float(level.sample_variance(dt)[0]) if len(dt) else None)
    if not len(dt):
        return np.array(measured, dtype=np.float64), np.zeros(len(measured))
    estimates = course(level, Steps(dt, dt), measured[1:]).estimates
    return estimates, np.concatenate([[0.0], measured[1:] - estimates[:-1]])
