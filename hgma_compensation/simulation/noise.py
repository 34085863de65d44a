"""Noise of the readout, and one stream of random numbers for each source of it."""

import zlib
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

Array = NDArray[np.float64]
Streams = Callable[[str], np.random.Generator]
"""Gives the generator of a named source: what one source draws changes nothing in another."""

PER_DECADE = 3
"""Relaxation times a decade: the sum then follows 1/f to within 0.3 %."""


def streams_of(seed: int) -> Streams:
    """Return the streams of a seed; a name gives the same numbers whatever else the scenario has."""
    return lambda name: np.random.default_rng([seed, zlib.crc32(name.encode())])


def white_noise(count: int, density: float, rate: float, random: np.random.Generator) -> Array:
    """Return samples (count,) whose Allan deviation is density/√τ: standard deviation density·√rate.

    density: velocity random walk N, unit/√Hz in the sense of IEEE Std 952 (two-sided N²).
    """
    return np.asarray(density * np.sqrt(rate) * random.standard_normal(count))


def flicker_noise(count: int, instability: float, random: np.random.Generator) -> Array:
    """Return samples (count,) of 1/f noise whose Allan deviation is flat at 0.664·instability.

    A sum of stationary first-order relaxation processes with log-spaced times τ and equal variances (van der Ziel
    1950). Their one-sided spectrum is ∫ s·4τ/(1 + (2πfτ)²) d ln τ = s/f, and the Allan variance of h/f is 2 ln 2·h; it
    is (2 ln 2/π)·B² (IEEE Std 952-1997, eq. C.9) where h = B²/π. So each process has the variance B²·Δ(ln τ)/π.
    Times run from one sample to ten recordings.
    """
    total = np.zeros(count)
    if instability == 0.0:
        return total
    decades = np.log10(10.0 * max(count, 2))
    ratio = np.log(10.0) / PER_DECADE
    deviation = instability * np.sqrt(ratio / np.pi)
    for exponent in np.arange(int(np.ceil(decades * PER_DECADE)) + 1):
        keep = float(np.exp(-np.exp(-exponent * ratio)))
        steps = deviation * random.standard_normal(count)
        steps[1:] *= np.sqrt(1.0 - keep**2)
        total += lfilter([1.0], [1.0, -keep], steps)
    return total
