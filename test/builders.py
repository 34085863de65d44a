"""Calibrations and recordings made by hand, so that a test knows the truth behind them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration, ChannelError
from hgma_compensation.calibration.document import with_id
from hgma_compensation.channels import CHANNELS
from hgma_compensation.drift.inputs import InputScaling
from hgma_compensation.drift.model import CalibratedRange, DriftModel
from hgma_compensation.drift.polynomial import CUBIC_WITH_RATE, PolynomialDrift
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.features import FeatureSettings, Product
from hgma_compensation.temperature.trend_filter import TrendNoise

Array = NDArray[np.float64]
EPOCH = 1_700_000_000 * NANOSECONDS
"""Stamp of the first sample of every made recording, ns."""

LINEAR = CHANNELS[:3]
MEAN_TEMPERATURE, HALF_SPAN = 25.0, 35.0
SCALING = InputScaling(np.array([MEAN_TEMPERATURE, 0.0, 0.0]), np.array([HALF_SPAN, 0.05, 100.0]))


def make_stamps(seconds: Array, epoch: int = EPOCH) -> NDArray[np.int64]:
    """Return times in s as stamps in ns."""
    return epoch + np.rint(np.asarray(seconds) * NANOSECONDS).astype(np.int64)


def triangle(seconds: Array, period: float, low: float = -10.0, high: float = 60.0) -> Array:
    """Return a temperature that starts at low, reaches high after half a period and returns."""
    return np.asarray(np.interp(seconds % period, [0.0, 0.5 * period, period], [low, high, low]))


def true_drift(temperature: Array, span: float = 50.0) -> Array:
    """Return a smooth, bent drift that changes by about span over -10 to 60 °C and is no network."""
    x = (temperature - MEAN_TEMPERATURE) / HALF_SPAN
    return np.asarray(span * (0.4 * x + 0.15 * x**2 + 0.1 * np.sin(2.0 * x)))


def make_recording(
    seed: int = 1,
    duration_s: float = 600.0,
    accel_rate: float = 20.0,
    thermistor_rate: float = 5.0,
    *,
    cycles: float = 3.0,
    channels: Sequence[str] = LINEAR,
    still: float = 9.81,
    span: float = 50.0,
    noise: float = 0.05,
    thermistor_noise: float = 0.01,
    low: float = -10.0,
    high: float = 60.0,
    name: str = "made",
) -> Recording:
    """Return a still sensor in an oven: value = still + true_drift(T, scale * span) + white noise.

    The temperature runs through ``cycles`` triangles from low to high and back. The first channel drifts
    by span, the second by half of it, the third by a third. noise: standard deviation of one sample.
    """
    random = np.random.default_rng(seed)
    period = duration_s / cycles
    thermistor_time = np.arange(int(duration_s * thermistor_rate)) / thermistor_rate
    time = np.arange(int(duration_s * accel_rate)) / accel_rate
    measured = triangle(thermistor_time, period, low, high)
    measured = measured + thermistor_noise * random.standard_normal(len(measured))
    values = np.zeros((len(time), len(CHANNELS)))
    for number, channel in enumerate(channels, start=1):
        drift = true_drift(triangle(time, period, low, high), span / number)
        values[:, CHANNELS.index(channel)] = still + drift + noise * random.standard_normal(len(time))
    return Recording(
        name=name,
        stamps=make_stamps(time),
        values=values,
        present=tuple(channel for channel in CHANNELS if channel in channels),
        temperature=Series(make_stamps(thermistor_time), measured),
    )


def make_rbf(seed: int = 1, centres: int = 5) -> RadialBasisDrift:
    """Return a network with random centres inside the scaled box."""
    random = np.random.default_rng(seed)
    return RadialBasisDrift(
        SCALING,
        centres=random.uniform(-1.0, 1.0, (centres, 3)),
        widths=random.uniform(0.5, 3.0, (centres, 3)),
        weights=random.normal(0.0, 10.0, centres),
        bias=float(random.normal(0.0, 1.0)),
        linear=random.normal(0.0, 5.0, 3),
    )


def make_polynomial(seed: int = 1) -> PolynomialDrift:
    """Return a cubic in temperature with rate terms."""
    coefficients = np.random.default_rng(seed).normal(0.0, 5.0, len(CUBIC_WITH_RATE))
    return PolynomialDrift(SCALING, CUBIC_WITH_RATE, coefficients)


def make_calibration(
    seed: int = 1,
    *,
    method: str = "rbf",
    channels: Sequence[str] = LINEAR,
    mode: FilterMode = FilterMode.OFF,
    product: Product = Product.DELAY,
    delay: float = 20.0,
    latency: float = 0.05,
    sensor_id: str = "imu_link",
    effects: Sequence[AppliedEffect] = (),
) -> Calibration:
    """Return a valid calibration with its id; method: rbf or polynomial, for all channels."""
    drifts: list[DriftModel] = [
        make_rbf(seed + number) if method == "rbf" else make_polynomial(seed + number)
        for number in range(len(channels))
    ]
    noise = RandomWalkNoise.with_time_constant(white=0.02, seconds=0.5)
    stage = (
        FilterSettings()
        if mode is FilterMode.OFF
        else FilterSettings(mode, noise, initial_bias=0.1 if mode is FilterMode.BIAS else 0.0)
    )
    return with_id(
        Calibration(
            sensor_id=sensor_id,
            features=FeatureSettings(
                TrendNoise(process=1e-5, measurement=1e-4), product=product, delay=delay, latency=latency
            ),
            calibrated_range=CalibratedRange(np.array([-11.0, -1.0, -2000.0]), np.array([61.0, 1.0, 2000.0])),
            channels=tuple(
                ChannelCalibration(name, drift, reference=9.81, filter=stage, error=ChannelError(0.1, 0.05, 0.2))
                for name, drift in zip(channels, drifts, strict=True)
            ),
            training={
                "tool": "test",
                "method": method,
                "seed": seed,
                "block": 5.0,
                "reference": "mean",
                "recordings": [{"name": "made", "start": EPOCH, "duration": 600.0, "samples": 12000}],
            },
            effects=tuple(effects),
        )
    )
