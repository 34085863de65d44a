"""Random-walk Kalman filter, Eqs. (7) to (11) of Zhu et al. 2019.

State: the compensated acceleration x, x' = x + w. Measured: z = x + v. The white noise of the sensor
and the random walk of the state are given as densities, so the filter means the same at every
sampling rate: R = N² / dt, Q = q² dt.
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
    """Streaming filter of one channel; a batch runs through the same steps."""

    def __init__(self, noise: RandomWalkNoise) -> None:
        """Start without a sample."""
        self._white, self._walk = noise.white * noise.white, noise.walk * noise.walk
        self.reset()

    def reset(self) -> None:
        """Forget every sample."""
        self._estimate: float | None = None
        self._variance: float | None = None
        self._newest = 0

    def run(self, stamps: Stamps, measured: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return (estimates, innovations), each (n,), of finite measurements (n,) at stamps (ns)."""
        if not len(stamps):
            return np.empty(0), np.empty(0)
        first = stamps[0] if self._estimate is None else self._newest
        # A late sample does not turn the clock back for those after it.
        newest = np.maximum.accumulate(np.concatenate([[first], stamps]))
        steps = seconds_between(stamps, newest[:-1]).tolist()
        estimates, innovations = np.empty(len(stamps)), np.empty(len(stamps))
        for k, (dt, z) in enumerate(zip(steps, measured.tolist(), strict=True)):
            estimates[k], innovations[k] = self._step(dt, z)
        self._newest = int(newest[-1])
        return estimates, innovations

    def _step(self, dt: float, z: float) -> tuple[float, float]:
        if self._estimate is None:
            self._estimate = z
            return z, 0.0
        innovation = z - self._estimate  # Eq. (7): the state is predicted unchanged
        if dt <= 0.0:  # A repeated or late stamp has no interval, hence no known noise: it corrects nothing.
            return self._estimate, innovation
        sample_variance = self._white / dt
        # The first sample's own interval is unknown; it is given the noise of the second.
        variance = sample_variance if self._variance is None else self._variance
        predicted = variance + self._walk * dt  # Eq. (8)
        gain = predicted / (predicted + sample_variance)  # Eq. (9)
        self._estimate += gain * innovation  # Eq. (10)
        self._variance = (1.0 - gain) * predicted  # Eq. (11)
        return self._estimate, innovation
