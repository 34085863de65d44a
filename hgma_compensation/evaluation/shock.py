"""What compensation does to a shock: peak, width and velocity change of what was injected and of what came out.

A still sensor is run through the pipeline twice with the same noise, once with the shock on top. The
difference of the outputs is what became of the shock.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.stamps import NANOSECONDS, Stamps

Array = NDArray[np.float64]

LEAD_IN, TAIL = 20_000, 2_000
"""Samples before the shock, over which the filter settles, and after it, into which velocity is integrated."""


RINGING = 600
"""Samples after the peak that belong to the shock: twenty times the width of the measured ones."""


@dataclass(frozen=True)
class ShockErrors:
    """Relative errors of the compensated shock; width at half of the respective peak, None where it has no width.

    velocity_change: from the beginning until RINGING samples after the peak. velocity_of_record: until the end
    of the record, with what rings on below the noise.
    """

    peak: float
    width: float | None
    velocity_change: float
    velocity_of_record: float


@dataclass(frozen=True)
class StillSensor:
    """Where the shock strikes. temperature: °C. white_noise: m/s²/√Hz."""

    temperature: float = 25.0
    white_noise: float = 0.0
    seed: int = 1


def half_sine(rate: float, seconds: float = 1e-3, peak: float = 10_000.0 * STANDARD_GRAVITY) -> Array:
    """Return a half-sine (n,) of the duration and peak (m/s²), sampled at ``rate`` Hz, zero at both ends."""
    count = round(seconds * rate)
    return np.asarray(peak * np.sin(np.pi * np.arange(count + 1) / count))


def shock_errors(
    calibration: Calibration, rate: float, shock: Array | None = None, sensor: StillSensor | None = None
) -> ShockErrors:
    """Return the errors of a shock (n,) in m/s² at ``rate`` Hz on the calibration's first channel.

    Without a shock it is the half-sine of 1 ms and 10 000 g.
    """
    shock = half_sine(rate) if shock is None else shock
    out = compensated_shock(calibration, rate, shock, sensor or StillSensor())
    injected = np.concatenate([shock, np.zeros(TAIL)])
    width = width_at_half_height(out)
    true_width = width_at_half_height(injected)
    end = int(np.argmax(np.abs(injected))) + RINGING
    return ShockErrors(
        peak=float(np.abs(out).max() / np.abs(injected).max() - 1.0),
        width=None if width is None or not true_width else width / true_width - 1.0,
        velocity_change=float(out[:end].sum() / injected[:end].sum() - 1.0),
        velocity_of_record=float(out.sum() / injected.sum() - 1.0),
    )


def compensated_shock(calibration: Calibration, rate: float, shock: Array, sensor: StillSensor) -> Array:
    """Return what the pipeline makes of the shock, shape (n + TAIL,): with it minus without it.

    An open gate lets the noise through that a closed one smooths, so that their difference would be noise;
    the mean over a noise and its negative is free of it, and keeps what opening late costs.
    """
    count = LEAD_IN + len(shock) + TAIL
    stamps = 10 * NANOSECONDS + np.rint(np.arange(count) * NANOSECONDS / rate).astype(np.int64)
    noise = np.random.default_rng(sensor.seed).standard_normal(count) * sensor.white_noise * np.sqrt(rate)
    pulse = np.zeros(count)
    pulse[LEAD_IN : LEAD_IN + len(shock)] = shock
    signs = (1.0, -1.0) if sensor.white_noise > 0.0 else (1.0,)
    outputs = [
        _output(calibration, stamps, sensor, sign * noise + pulse) - _output(calibration, stamps, sensor, sign * noise)
        for sign in signs
    ]
    return np.asarray(np.mean(outputs, axis=0)[LEAD_IN:])


def width_at_half_height(pulse: Array) -> float | None:
    """Return the width in samples around the peak of |pulse| (n,), edges interpolated; None if it never falls."""
    height = np.abs(pulse)
    top = int(np.argmax(height))
    half = 0.5 * height[top]
    left = np.flatnonzero(height[: top + 1] < half)
    right = np.flatnonzero(height[top:] < half)
    if not len(right) or half <= 0.0:
        return None
    end = top + int(right[0])
    after = end - (half - height[end]) / (height[end - 1] - height[end])
    if not len(left):
        return float(after)
    start = int(left[-1])
    return float(after - start - (half - height[start]) / (height[start + 1] - height[start]))


def _output(calibration: Calibration, stamps: Stamps, sensor: StillSensor, acceleration: Array) -> Array:
    """Return the first channel's output (n,) for an acceleration (n,) about the still value, drift added."""
    values = _still(calibration, stamps, sensor)
    values[:, 0] += acceleration
    return _run(calibration, stamps, sensor, values).values[:, 0]


def _still(calibration: Calibration, stamps: Stamps, sensor: StillSensor) -> Array:
    """Return what the sensor shows at rest, (n, c)."""
    references = np.array([channel.reference for channel in calibration.channels])
    values = np.zeros((len(stamps), len(references)))
    # Effects that answer to the acceleration vanish at rest, which is found once the rest of the drift is known.
    for _ in range(3 if any(applied.effect.per_sample for applied in calibration.effects) else 1):
        values = _run(calibration, stamps, sensor, values).drift + references
    return values


def _run(calibration: Calibration, stamps: Stamps, sensor: StillSensor, values: Array) -> Compensated:
    imu = np.zeros((len(stamps), len(CHANNELS)))
    return _warm(calibration, sensor, int(stamps[-1])).compensate(stamps, values, imu)


def _warm(calibration: Calibration, sensor: StillSensor, until: int) -> Pipeline:
    """Return a pipeline whose thermistor has shown the still temperature every second until a stamp (ns)."""
    pipeline = Pipeline(calibration)
    seconds = np.arange(0, until + NANOSECONDS, NANOSECONDS)
    pipeline.track.extend(seconds, np.full(len(seconds), sensor.temperature))
    return pipeline
