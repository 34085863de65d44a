"""Vibration: its samples where the sample rate holds them, and its power, which rectification answers to."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfilt

from hgma_compensation.channels import AXES
from hgma_compensation.simulation.motion_description import Vibration

Array = NDArray[np.float64]


def vibrate(vibration: Vibration, time: Array, rate: float, random: np.random.Generator) -> Array:
    """Return the vibration (n,) at times (n,) in m/s²: a tone, or a band of Gaussian noise of the given rms.

    What lies above half the sample rate is taken to stop at the converter's anti-alias filter.
    """
    inside = (time >= vibration.start) & (time < vibration.end)
    high = min(vibration.high, 0.499 * rate)
    if vibration.low > high:
        return np.zeros(len(time))
    if vibration.low == vibration.high:
        phase = random.uniform(0.0, 2.0 * np.pi)
        tone = np.sin(2.0 * np.pi * vibration.low * time + phase)
        return np.asarray(np.where(inside, np.sqrt(2.0) * vibration.rms * tone, 0.0))
    noise = sosfilt(
        butter(4, (vibration.low, high), "bandpass", fs=rate, output="sos"), random.standard_normal(len(time))
    )
    # Of the band's power only the part below half the sample rate is left.
    share = (high - vibration.low) / (vibration.high - vibration.low)
    deviation = float(noise[inside].std()) if inside.sum() > 1 else 1.0
    return np.asarray(np.where(inside, vibration.rms * np.sqrt(share) * noise / deviation, 0.0))


def vibration_power(vibrations: tuple[Vibration, ...], time: Array) -> Array:
    """Return the mean square (n, 3) of the vibration in (m/s²)², whatever its frequency."""
    power = np.zeros((len(time), len(AXES)))
    for vibration in vibrations:
        inside = (time >= vibration.start) & (time < vibration.end)
        power[inside, AXES.index(vibration.axis)] += vibration.rms**2
    return power
