"""Random-walk Kalman filter, Eqs. (7) to (11) of Zhu et al. 2019.

State: a level x, x' = x + w. Measured: z = x + v. The white noise of the sensor and the random walk
of the state are given as densities, so the filter means the same at every sampling rate:
R = N² / dt, Q = q² dt. The gain varies until it has settled, by the Riccati recursion with the real
time steps.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps, seconds_between


@dataclass(frozen=True)
class RandomWalkNoise:
    """Noise densities of one channel.

    white: velocity random walk N of the measurement, unit/√Hz. walk: random walk q of the state,
    unit/√s.
    """

    white: float
    walk: float

    @classmethod
    def with_time_constant(cls, white: float, seconds: float) -> "RandomWalkNoise":
        """Return the noise whose settled filter averages over about the given time.

        The continuous filter's gain is q/N, and its time constant N/q.
        """
        return cls(white=white, walk=white / seconds)


class RandomWalkFilter:
    """One channel's estimate and its variance, moved by the caller from sample to sample."""

    def __init__(self, noise: RandomWalkNoise) -> None:
        """Start without a sample."""
        self._white, self._walk = noise.white * noise.white, noise.walk * noise.walk
        self.reset()

    def reset(self) -> None:
        """Forget every sample."""
        self.started = False
        self.estimate = 0.0
        self.variance: float | None = None

    def start(self, estimate: float, variance: float | None = None) -> None:
        """Begin at an estimate; without a variance it is a sample whose own interval is unknown."""
        self.started, self.estimate, self.variance = True, estimate, variance

    def sample_variance(self, dt: float) -> float:
        """Return R of a sample that averages over dt (s)."""
        return self._white / dt

    def predict(self, dt: float, averaged: float | None = None) -> float:
        """Let dt (s, > 0) pass and return the variance of the innovation to come: Eqs. (7), (8).

        The level is predicted unchanged. A first sample of unknown interval is given the noise of the
        second. averaged: s that the sample averages over, where that is not dt.
        """
        sample_variance = self._white / (dt if averaged is None else averaged)
        self.variance = (sample_variance if self.variance is None else self.variance) + self._walk * dt
        return self.variance + sample_variance

    def correct(self, innovation: float, innovation_variance: float) -> None:
        """Take the measurement in: Eqs. (9) to (11)."""
        assert self.variance is not None
        gain = self.variance / innovation_variance  # Eq. (9)
        self.estimate += gain * innovation  # Eq. (10)
        self.variance = (1.0 - gain) * self.variance  # Eq. (11)


def filter_samples(
    noise: RandomWalkNoise, stamps: Stamps, measured: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return estimates and innovations, each (n,), of the plain filter over measurements (n,) at stamps (ns).

    No gate: real acceleration is smoothed away with the noise. For comparison, and for records at rest.
    """
    level = RandomWalkFilter(noise)
    level.start(float(measured[0]))
    estimates, innovations = np.array(measured, dtype=np.float64), np.zeros(len(measured))
    steps = seconds_between(stamps[1:], stamps[:-1]).tolist()
    for k, (dt, z) in enumerate(zip(steps, measured[1:].tolist(), strict=True), start=1):
        innovation_variance = level.predict(dt)
        innovations[k] = z - level.estimate
        level.correct(innovations[k], innovation_variance)
        estimates[k] = level.estimate
    return estimates, innovations
