"""Calibrations whose output is known exactly, and files that are refused."""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.soak.provenance import provenance
from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration, ChannelError
from hgma_compensation.calibration.document import LARGEST_FILE, MOST_COMMAS, with_id, write_calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.drift.inputs import InputScaling
from hgma_compensation.drift.model import CalibratedRange, DriftModel
from hgma_compensation.drift.polynomial import PolynomialDrift
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.kalman.settings import FilterSettings
from hgma_compensation.temperature.features import FeatureSettings
from hgma_compensation.temperature.trend_filter import TrendNoise


def constant_drift(offset: float, centres: int) -> DriftModel:
    """Return a drift of exactly an offset: a polynomial of degree 0, or a network whose weights are all 0."""
    scaling = InputScaling(np.zeros(3), np.ones(3))
    if not centres:
        return PolynomialDrift(scaling, np.zeros((1, 3), dtype=np.int64), np.array([offset]))
    random = np.random.default_rng(int(offset))
    return RadialBasisDrift(
        scaling,
        centres=random.uniform(-1.0, 1.0, (centres, 3)),
        widths=random.uniform(0.5, 3.0, (centres, 3)),
        weights=np.zeros(centres),
        bias=offset,
        linear=np.zeros(3),
    )


def constant_calibration(offset: float, channels: Sequence[str], centres: int) -> Calibration:
    """Return a calibration that subtracts exactly an offset (m/s²) from each channel; centres: 0 for polynomials."""
    drift = constant_drift(offset, centres)
    return with_id(
        Calibration(
            sensor_id="soak",
            features=FeatureSettings(TrendNoise(process=1e-5, measurement=1e-4), delay=20.0, latency=0.05),
            calibrated_range=CalibratedRange(np.array([-11.0, -1.0, -2000.0]), np.array([61.0, 1.0, 2000.0])),
            channels=tuple(
                ChannelCalibration(name, drift, 0.0, FilterSettings(), ChannelError(0.1, 0.05)) for name in channels
            ),
            training=provenance("rbf" if centres else "polynomial", int(offset)),
        )
    )


def write_calibrations(directory: Path, count: int, centres: int, channels: int) -> dict[Path, Calibration]:
    """Write calibrations that subtract 1, 2, … m/s² from x, and from as many more channels as asked for."""
    written = {}
    for number in range(1, count + 1):
        calibration = constant_calibration(float(number), CHANNELS[:channels], centres)
        written[directory / f"calibration_{number}.json"] = calibration
        write_calibration(calibration, directory / f"calibration_{number}.json")
    return written


def write_refused(directory: Path, whole: bytes) -> list[Path]:
    """Write what is refused, each for another reason, given the bytes of a calibration."""
    contents = {
        "truncated.json": whole[: len(whole) // 2],
        "edited.json": whole.replace(b'"seed": 1', b'"seed": 3'),
        "junk.json": b"[" + b"[1.25]," * MOST_COMMAS + b"0]",
        "large.json": b" " * (LARGEST_FILE + 1),
    }
    for name, content in contents.items():
        (directory / name).write_bytes(content)
    os.mkfifo(directory / "pipe.json")
    (directory / "device.json").symlink_to("/dev/zero")
    return [directory / name for name in (*contents, "pipe.json", "device.json", "missing.json", ".")]
