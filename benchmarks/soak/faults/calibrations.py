"""Calibrations with a Kalman stage and memories of every sort, and a file that is refused."""

from pathlib import Path

import numpy as np

from benchmarks.soak.provenance import provenance
from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration, ChannelError
from hgma_compensation.calibration.document import with_id, write_calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.drift.inputs import InputScaling
from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.drift.polynomial import PolynomialDrift
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.temperature.features import FeatureSettings
from hgma_compensation.temperature.trend_filter import TrendNoise

X, Y, Z = CHANNELS[:3]
EFFECTS: tuple[tuple[str, str, dict[str, object], tuple[float, ...]], ...] = (
    (X, "stress_relaxation", {"time_constant": 5000.0, "spread": 1.0}, (0.1,)),
    (X, "vibration_rectification", {"time_constant": 5.0, "floor": 0.0, "channel": X}, (1e-4,)),
    (Y, "thermal_gradient", {}, (0.2, 0.1)),
    (Z, "supply_voltage", {"nominal": 5.0}, (2.0, 0.5)),
    (Z, "warm_up", {"time_constant": 600.0, "spread": 1.0}, (1.0,)),
    (Z, "post_shock_zero_shift", {"threshold": 500.0, "time_constant": 300.0, "channel": Z}, (1e-3, 1e-3)),
)


def calibration(seed: int, modes: tuple[FilterMode, FilterMode, FilterMode]) -> Calibration:
    """Return a calibration of three axes, one Kalman stage for each."""
    random = np.random.default_rng(seed)
    scaling = InputScaling(np.array([25.0, 0.0, 0.0]), np.array([35.0, 0.05, 100.0]))
    exponents = np.array([[1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0]])
    noise = RandomWalkNoise.with_time_constant(0.02, 20.0)
    filters = {
        FilterMode.OFF: FilterSettings(),
        FilterMode.SMOOTH: FilterSettings(FilterMode.SMOOTH, noise, wander=0.1),
        FilterMode.BIAS: FilterSettings(FilterMode.BIAS, noise, wander=0.1, initial_bias=1.0),
    }
    return with_id(
        Calibration(
            sensor_id="soak",
            features=FeatureSettings(TrendNoise(process=1e-6, measurement=1e-4), latency=0.25),
            calibrated_range=CalibratedRange(np.array([-11.0, -1.0, -2000.0]), np.array([61.0, 1.0, 2000.0])),
            channels=tuple(
                ChannelCalibration(
                    name,
                    PolynomialDrift(scaling, exponents, random.normal(0.0, 5.0, len(exponents))),
                    reference=9.81,
                    filter=filters[mode],
                    error=ChannelError(0.1, 0.05),
                )
                for name, mode in zip((X, Y, Z), modes, strict=True)
            ),
            training=provenance("polynomial", seed),
            effects=tuple(
                AppliedEffect(channel, make(name, parameters), np.array(gains))
                for channel, name, parameters, gains in EFFECTS
            ),
        )
    )


def write_calibrations(folder: Path) -> tuple[list[Path], Path]:
    """Write two calibrations that are good, and one that is not; return their paths."""
    off, smooth, bias = FilterMode
    good = [folder / "first.json", folder / "second.json"]
    for seed, (path, modes) in enumerate(zip(good, ((off, smooth, bias), (bias, off, smooth)), strict=True)):
        write_calibration(calibration(seed, modes), path)
    refused = folder / "refused.json"
    refused.write_bytes(good[0].read_bytes()[:-200])
    return good, refused
