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

    Variances that stay are one number. added, sample_variances: Q and R, (n,), or one for all.
    """

    estimates: Array
    variances: float | Array
    innovation_variances: float | Array
    added: float | Array
    sample_variances: float | Array

    def take(self, level: RandomWalkFilter, count: int) -> None:
        """Move the filter, as it was before, on over the first ``count`` samples."""
        if not count:
            return
        level.estimate = float(self.estimates[count])
        if isinstance(self.variances, float):
            assert level.stretch is not None
            level.stretch.take_settled(count)
            return
        if isinstance(self.added, float) or isinstance(self.sample_variances, float):
            start, stretch = 0, level.stretch_of(float(self.added), float(self.sample_variances))
        else:
            start = int(starts(self.added[:count], self.sample_variances[:count])[-1])
            noise = float(self.added[start]), float(self.sample_variances[start])
            stretch = Stretch(*noise) if start else level.stretch_of(*noise)
        stretch.take(self.variances[start : count + 1])
        level.stretch, level.variance = stretch, float(self.variances[count])


def course(level: RandomWalkFilter, steps: Steps, samples: Array) -> Course:
    """Return what a filter whose variance is known does over samples (n,), n > 0, each of them with dt > 0.

    The filter stays as it is.
    """
    variance = level.variance
    assert variance is not None
    added, sample_variances = level.added_variance(steps.dt), level.sample_variance(steps.averaged)
    variances: float | Array
    if isinstance(added, float) and isinstance(sample_variances, float):
        stretch = level.stretch_of(added, sample_variances)
        if stretch.has_settled:
            predicted = variance + added
            keep = 1.0 - kalman_gain(predicted, sample_variances)
            estimates = low_pass(level.estimate, keep, samples)
            return Course(estimates, variance, predicted + sample_variances, added, sample_variances)
        variances = stretch.variances(variance, len(samples))
    else:
        added, sample_variances = np.asarray(added), np.asarray(sample_variances)
        variances = uneven_variances(level, variance, added, sample_variances)
    predicted_variances = variances[:-1] + added
    keeps = 1.0 - kalman_gain(predicted_variances, sample_variances)
    estimates = low_pass(level.estimate, keeps, samples)
    return Course(estimates, variances, predicted_variances + sample_variances, added, sample_variances)


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
