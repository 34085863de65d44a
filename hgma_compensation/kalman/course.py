"""The random-walk filter over many samples that are all taken in; every bit as RandomWalkFilter one by one."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.intervals import Steps, hold_steps
from hgma_compensation.kalman.low_pass import low_pass
from hgma_compensation.kalman.random_walk import RandomWalkFilter, RandomWalkNoise
from hgma_compensation.kalman.riccati import kalman_gain, riccati
from hgma_compensation.kalman.stretch import DIRECT, Stretch
from hgma_compensation.stamps import Stamps, seconds_between

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Course:
    """Estimates and their variances before the first sample and after each, (n + 1,), and of the innovations, (n,).

    Variances that stay are one number. added, sample_variances: Q and R, (n,), or () for all.
    """

    estimates: Array
    variances: float | Array
    innovation_variances: float | Array
    added: Array
    sample_variances: Array

    def take(self, level: RandomWalkFilter, count: int) -> None:
        """Move the filter, as it was before, on over the first ``count`` samples."""
        if not count:
            return
        level.estimate = float(self.estimates[count])
        if isinstance(self.variances, float):
            assert level.stretch is not None
            level.stretch.take_settled(count)
            return
        start, stretch = 0, level.stretch_of(float(self.added.flat[0]), float(self.sample_variances.flat[0]))
        if self.added.ndim and (start := int(starts(self.added[:count], self.sample_variances[:count])[-1])):
            stretch = Stretch(float(self.added[start]), float(self.sample_variances[start]))
        stretch.take(self.variances[start : count + 1])
        level.stretch, level.variance = stretch, float(self.variances[count])


def course(level: RandomWalkFilter, steps: Steps, samples: Array) -> Course:
    """Return what a filter whose variance is known does over samples (n,), n > 0, each of them with dt > 0.

    The filter stays as it is.
    """
    variance = level.variance
    assert variance is not None
    dt, averaged = steps
    if not isinstance(dt, float) and not isinstance(averaged, float):
        added, sample_variances = level.added_variance(dt), level.sample_variance(averaged)
        variances = uneven_variances(level, variance, added, sample_variances)
        return _with_varying_gain(level, variances, added, sample_variances, samples)
    walk, white = level.added_variance(float(dt)), level.sample_variance(float(averaged))
    stretch, every = level.stretch_of(walk, white), (np.array(walk), np.array(white))
    if not stretch.has_settled:
        return _with_varying_gain(level, stretch.variances(variance, len(samples)), *every, samples)
    predicted = variance + walk
    estimates = low_pass(level.estimate, 1.0 - kalman_gain(predicted, white), samples)
    return Course(estimates, variance, predicted + white, *every)


def _with_varying_gain(
    level: RandomWalkFilter, variances: Array, added: Array, sample_variances: Array, samples: Array
) -> Course:
    predicted = variances[:-1] + added
    estimates = low_pass(level.estimate, 1.0 - kalman_gain(predicted, sample_variances), samples)
    return Course(estimates, variances, predicted + sample_variances, added, sample_variances)


def uneven_variances(level: RandomWalkFilter, variance: float, added: Array, sample_variances: Array) -> Array:
    """Return the variance before the first and after each of n samples with Q and R, each (n,): (n + 1,)."""
    edges = np.append(starts(added, sample_variances), len(added))
    first = level.stretch_of(float(added[0]), float(sample_variances[0]))
    lengths = np.diff(edges)
    lengths[0] += first.count
    variances = np.empty(len(added) + 1)
    variances[0] = variance
    done = 0
    # Stretches that the closed form does not reach are stepped through together, whatever their number.
    for number in [*np.flatnonzero(lengths > DIRECT).tolist(), len(lengths)]:
        start = int(edges[number])
        variances[done : start + 1] = riccati(
            float(variances[done]), added[done:start].tolist(), sample_variances[done:start].tolist()
        )
        done = start
        if number < len(lengths):
            done = int(edges[number + 1])
            stretch = first if number == 0 else Stretch(float(added[start]), float(sample_variances[start]))
            variances[start : done + 1] = stretch.variances(float(variances[start]), done - start)
    return variances


def starts(added: Array, sample_variances: Array) -> NDArray[np.int64]:
    """Return where among samples with Q and R, each (n,), n > 0, stretches of equal ones begin."""
    changes = (added[1:] != added[:-1]) | (sample_variances[1:] != sample_variances[:-1])
    return np.append(0, np.flatnonzero(changes) + 1)


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
