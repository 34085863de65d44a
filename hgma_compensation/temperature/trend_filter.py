"""Local-linear-trend Kalman filter: temperature and its rate from a noisy thermistor.

State (T, Ṫ), Ṫ driven by white noise of density q: F = [[1, dt], [0, 1]],
Q = q [[dt³/3, dt²/2], [dt²/2, dt]], H = [1, 0] (Harvey 1989, Forecasting, Structural Time Series
Models and the Kalman Filter, ch. 2; Bar-Shalom et al. 2001, section 6.2.2, "continuous white noise
acceleration"). Written in scalars because a thermistor sample then costs 1 us instead of 70 us.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

INITIAL_RATE_SIGMA = 0.1
"""Standard deviation of Ṫ before any sample, °C/s: a fast oven ramps at 6 °C/min, a cold shock faster."""


@dataclass(frozen=True)
class TrendNoise:
    """Noise of the local linear trend.

    process: density of the white noise that drives Ṫ, (°C/s²)²·s.
    measurement: variance of one thermistor sample, °C².
    """

    process: float
    measurement: float


@dataclass(frozen=True)
class TrendStep:
    """What one sample did: the estimate after it, and the innovation it brought."""

    temperature: float
    rate: float
    innovation: float
    innovation_variance: float


class TrendFilter:
    """Streaming estimate of T and Ṫ; the first sample starts it."""

    def __init__(self, noise: TrendNoise) -> None:
        """Start without a sample."""
        self._noise = noise
        self.reset()

    def reset(self) -> None:
        """Forget every sample."""
        self._started = False
        self._temperature = self._rate = 0.0
        self._p_tt = self._p_tr = self._p_rr = 0.0

    def snapshot(self) -> list[float]:
        """Return the state as plain JSON, empty before the first sample."""
        if not self._started:
            return []
        return [self._temperature, self._rate, self._p_tt, self._p_tr, self._p_rr]

    def restore(self, snapshot: Sequence[float]) -> None:
        """Go on from a snapshot; raises ValueError where it is none."""
        self.reset()
        if snapshot:
            self._temperature, self._rate, self._p_tt, self._p_tr, self._p_rr = (float(value) for value in snapshot)
            if min(self._p_tt, self._p_rr) < 0.0 or self._p_tr**2 > self._p_tt * self._p_rr * (1.0 + 1e-6):
                raise ValueError("a covariance that is none")
            self._started = True

    def step(self, dt: float, measured: float) -> TrendStep:
        """Predict over dt (s, since the sample before) and correct with a finite sample (°C)."""
        q, r = self._noise.process, self._noise.measurement
        if not self._started:
            self._started = True
            self._temperature, self._rate = measured, 0.0
            self._p_tt, self._p_tr, self._p_rr = r, 0.0, INITIAL_RATE_SIGMA**2
            return TrendStep(measured, 0.0, 0.0, inf)
        predicted = self._temperature + self._rate * dt
        p_tt = self._p_tt + 2.0 * dt * self._p_tr + dt * dt * self._p_rr + q * dt * dt * dt / 3.0
        p_tr = self._p_tr + dt * self._p_rr + q * dt * dt / 2.0
        p_rr = self._p_rr + q * dt
        variance = p_tt + r
        innovation = measured - predicted
        gain_t, gain_r = p_tt / variance, p_tr / variance
        self._temperature = predicted + gain_t * innovation
        self._rate = self._rate + gain_r * innovation
        self._p_tt, self._p_tr, self._p_rr = (
            (1.0 - gain_t) * p_tt,
            (1.0 - gain_t) * p_tr,
            p_rr - gain_r * p_tr,
        )
        return TrendStep(self._temperature, self._rate, innovation, variance)
