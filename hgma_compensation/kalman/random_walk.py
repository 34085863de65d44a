"""Random-walk Kalman filter, Eqs. (7) to (11) of Zhu et al. 2019.

State: a level x, x' = x + w. Measured: z = x + v. The white noise of the sensor and the random walk
of the state are given as densities, so the filter means the same at every sampling rate:
R = N² / dt, Q = q² dt. The gain varies until it has settled, by the Riccati recursion with the time
steps as intervals.py takes them, and by its closed form where they are even (stretch.py).
"""

from dataclasses import dataclass

from hgma_compensation.kalman.low_pass import low_pass_step
from hgma_compensation.kalman.riccati import Number, kalman_gain
from hgma_compensation.kalman.stretch import Stretch


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
        self.stretch: Stretch | None = None
        self._added = 0.0

    def start(self, estimate: float, variance: float | None = None) -> None:
        """Begin at an estimate; without a variance it is a sample whose own interval is unknown."""
        self.started, self.estimate, self.variance, self.stretch = True, estimate, variance, None

    def stretch_of(self, added: float, sample_variance: float) -> Stretch:
        """Return the even stretch that a sample with Q and R goes on with, or begins."""
        stretch = self.stretch
        if stretch is not None and stretch.added == added and stretch.sample_variance == sample_variance:
            return stretch
        return Stretch(added, sample_variance)

    def sample_variance(self, averaged: Number) -> Number:
        """Return R of samples that average over so many s."""
        return self._white / averaged

    def added_variance(self, dt: Number) -> Number:
        """Return Q, which the walk adds within dt (s)."""
        return self._walk * dt

    def predict(self, dt: float, sample_variance: float) -> float:
        """Let dt (s, > 0) pass and return the variance of the innovation to come: Eqs. (7), (8).

        The level is predicted unchanged. A first sample of unknown interval is given the noise of the second.
        """
        self._added = self.added_variance(dt)
        self.variance = (sample_variance if self.variance is None else self.variance) + self._added
        return self.variance + sample_variance

    def correct(self, measured: float, sample_variance: float) -> None:
        """Take the measurement in: Eqs. (9) to (11)."""
        assert self.variance is not None
        gain = kalman_gain(self.variance, sample_variance)
        self.estimate = low_pass_step(self.estimate, 1.0 - gain, measured)  # Eq. (10)
        stretch = self.stretch = self.stretch_of(self._added, sample_variance)
        self.variance = stretch.step(gain * sample_variance)  # Eq. (11): (1 - K) V = K R
