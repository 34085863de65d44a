"""Temperature without lag: the thermistor seen from both sides.

A causal estimate of the temperature trails at corners, and would itself look like a thermal lag.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import NANOSECONDS, Stamps
from hgma_compensation.temperature.trend_filter import INITIAL_RATE_SIGMA, TrendNoise

Array = NDArray[np.float64]

AT_ONCE = 4096
"""Samples that are made numbers of Python at once."""

SPACING = 1.0
"""s: faster thermistors are averaged over this time first, which loses nothing that a sensor could follow."""


@dataclass(frozen=True)
class Smoothed:
    """stamps (m,) ns; temperature (m,) °C and rate (m,) °C/s at them; variance: of the temperature, °C²."""

    stamps: Stamps
    temperature: Array
    rate: Array
    variance: Array


def thinned(stamps: Stamps, values: Array, noise: TrendNoise) -> tuple[Stamps, Array, TrendNoise]:
    """Return means over SPACING where the samples are closer than that, and the noise of them."""
    if len(stamps) < 3:
        return stamps, values, noise
    interval = float(np.median(np.diff(stamps))) / NANOSECONDS
    size = int(SPACING / interval + 1e-6)
    if size < 2:
        return stamps, values, noise
    index = np.floor((stamps - stamps[0]) / (SPACING * NANOSECONDS)).astype(np.int64)
    starts = np.flatnonzero(np.diff(index, prepend=-1))
    counts = np.diff(np.append(starts, len(index)))
    offsets = np.add.reduceat((stamps - stamps[0]).astype(np.float64), starts) / counts
    means = np.add.reduceat(values, starts) / counts
    return stamps[0] + np.rint(offsets).astype(np.int64), means, TrendNoise(noise.process, noise.measurement / size)


def smooth(stamps: Stamps, values: Array, noise: TrendNoise) -> Smoothed:
    """Return the fixed-interval estimate (Rauch, Tung and Striebel 1965) of the local linear trend.

    stamps (m,): ns, increasing. values (m,): °C.
    """
    count = len(stamps)
    steps = np.diff(stamps, prepend=stamps[:1]) * 1e-9
    q, r = noise.process, noise.measurement
    kept = np.empty((count, 5))  # filtered T, Ṫ and their variances and covariance
    t, v, ptt, ptv, pvv = float(values[0]), 0.0, r, 0.0, INITIAL_RATE_SIGMA**2
    kept[0] = t, v, ptt, ptv, pvv
    for k, (dt, value) in enumerate(_lists(steps[1:], values[1:]), start=1):
        t += v * dt
        ptt += 2.0 * dt * ptv + dt * dt * pvv + q * dt**3 / 3.0
        ptv += dt * pvv + q * dt * dt / 2.0
        pvv += q * dt
        gain_t, gain_v = ptt / (ptt + r), ptv / (ptt + r)
        innovation = value - t
        t, v = t + gain_t * innovation, v + gain_v * innovation
        ptt, ptv, pvv = (1.0 - gain_t) * ptt, (1.0 - gain_t) * ptv, pvv - gain_v * ptv
        kept[k] = t, v, ptt, ptv, pvv
    return _backward(stamps, steps, kept, q)


def _backward(stamps: Stamps, steps: Array, kept: Array, q: float) -> Smoothed:
    smoothed = np.empty((len(stamps), 3))
    t, v, ptt, ptv, pvv = kept[-1].tolist()
    smoothed[-1] = t, v, ptt
    for k, (ft, fv, a, b, c) in zip(range(len(stamps) - 2, -1, -1), _lists(*kept[-2::-1].T), strict=True):
        dt = float(steps[k + 1])
        # Predicted covariance M = F P Fᵀ + Q and gain G = P Fᵀ M⁻¹, written out for two states.
        mtt = a + 2.0 * dt * b + dt * dt * c + q * dt**3 / 3.0
        mtv = b + dt * c + q * dt * dt / 2.0
        mvv = c + q * dt
        determinant = mtt * mvv - mtv * mtv
        ptf, ptg = a + dt * b, b  # P Fᵀ, first row
        pvf, pvg = b + dt * c, c
        g11, g12 = (ptf * mvv - ptg * mtv) / determinant, (ptg * mtt - ptf * mtv) / determinant
        g21, g22 = (pvf * mvv - pvg * mtv) / determinant, (pvg * mtt - pvf * mtv) / determinant
        dt_, dv = t - (ft + fv * dt), v - fv
        t, v = ft + g11 * dt_ + g12 * dv, fv + g21 * dt_ + g22 * dv
        dtt, dtv, dvv = ptt - mtt, ptv - mtv, pvv - mvv
        ptt, ptv, pvv = (
            a + g11 * g11 * dtt + 2.0 * g11 * g12 * dtv + g12 * g12 * dvv,
            b + g11 * g21 * dtt + (g11 * g22 + g12 * g21) * dtv + g12 * g22 * dvv,
            c + g21 * g21 * dtt + 2.0 * g21 * g22 * dtv + g22 * g22 * dvv,
        )
        smoothed[k] = t, v, ptt
    return Smoothed(stamps, smoothed[:, 0].copy(), smoothed[:, 1].copy(), smoothed[:, 2].copy())


def _lists(*columns: Array) -> Iterator[tuple[float, ...]]:
    """Yield the rows of columns (m,) as numbers of Python, which are few at a time: they take much more memory."""
    for start in range(0, len(columns[0]), AT_ONCE):
        yield from zip(*(column[start : start + AT_ONCE].tolist() for column in columns), strict=True)
