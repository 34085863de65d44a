"""Raw acceleration and thermistor in, compensated acceleration out: sample by sample or in bulk."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.kalman.stage import KalmanStage
from hgma_compensation.pipeline.status import TemperatureStatus, temperature_status
from hgma_compensation.stamps import Stamps
from hgma_compensation.temperature.features import read_features
from hgma_compensation.temperature.track import TIME_JUMP, Sample, TemperatureTrack

CHUNK = 65536
"""Samples evaluated at once: bounds the memory of the hidden layer."""

ACCELERATION_LAG = 60.0
"""Seconds by which a live accelerometer may lag its thermistor before history is dropped."""


@dataclass(frozen=True)
class Compensated:
    """Result for n samples and c channels, in the order of the calibration.

    values: compensated, (n, c). drift: what was subtracted, (n, c). innovation: of the Kalman stage,
    (n, c), 0 where it is off. features: (n, 3) before clamping; the middle of the calibrated range where
    the temperature is missing. inside_range: (n,). status: (n,) TemperatureStatus.
    """

    values: NDArray[np.float64]
    drift: NDArray[np.float64]
    innovation: NDArray[np.float64]
    features: NDArray[np.float64]
    inside_range: NDArray[np.bool_]
    status: NDArray[np.uint8]


class Pipeline:
    """State of one sensor's compensation under one calibration.

    Thermistor and accelerometer samples may be given in any interleaving; results are decided by
    stamps. jumps_back counts the times at which the accelerometer's stamps began anew. Not thread-safe.
    """

    def __init__(self, calibration: Calibration, *, live: bool = False) -> None:
        """Start without history; live: drop history that no sample can reach any more."""
        self.calibration = calibration
        keep = calibration.features.history + ACCELERATION_LAG if live else None
        self.track = TemperatureTrack(calibration.features.noise, keep=keep)
        self._filters = [
            None if channel.filter.noise is None else KalmanStage(channel.filter, channel.reference)
            for channel in calibration.channels
        ]
        self._newest: int | None = None
        self.jumps_back = 0

    @property
    def gate_openings(self) -> int:
        """How often real acceleration has opened the gate of any channel's Kalman stage."""
        return sum(stage.openings for stage in self._filters if stage is not None)

    def reset(self) -> None:
        """Forget thermistor history and filter states; the calibration stays."""
        self.track.reset()
        self._reset_filters()

    def _reset_filters(self) -> None:
        self._newest = None
        for stage in self._filters:
            if stage is not None:
                stage.reset()

    def add_temperature(self, stamp: int, celsius: float) -> Sample:
        """Take a thermistor sample (ns, °C) and say what became of it."""
        return self.track.add(stamp, celsius)

    def compensate(self, stamps: Stamps, values: NDArray[np.float64]) -> Compensated:
        """Compensate finite samples, values (n, c) at stamps (n,) in ns.

        Splitting the samples over several calls changes no bit of the result. A step back in time by
        more than TIME_JUMP begins the filters anew.
        """
        if len(stamps) <= CHUNK:
            return self._compensate_chunk(stamps, values)
        parts = [
            self._compensate_chunk(stamps[start : start + CHUNK], values[start : start + CHUNK])
            for start in range(0, len(stamps), CHUNK)
        ]
        return Compensated(
            *(np.concatenate([getattr(part, name) for part in parts]) for name in Compensated.__dataclass_fields__)
        )

    def _compensate_chunk(self, stamps: Stamps, values: NDArray[np.float64]) -> Compensated:
        calibration = self.calibration
        features = read_features(self.track, calibration.features, stamps)
        inside = calibration.calibrated_range.contains(features.values)
        status = temperature_status(features, calibration.features, inside)
        # Without any temperature the drift at the middle of the range is the best guess there is; the
        # status says that it is one.
        missing = (status == TemperatureStatus.MISSING)[:, None]
        known = np.where(missing, calibration.calibrated_range.middle, features.values)
        drift = self._drift(known)
        corrected = values - drift
        innovation = np.zeros_like(corrected)
        for stretch in self._stretches(stamps):
            self._filter(stamps[stretch], corrected[stretch], innovation[stretch])
        return Compensated(corrected, drift, innovation, known, inside, status)

    def _drift(self, features: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the drift, shape (n, c), at features clamped to the calibrated range."""
        clamped = self.calibration.calibrated_range.clamp(features)
        return np.stack([channel.drift.evaluate(clamped) for channel in self.calibration.channels], axis=1)

    def _stretches(self, stamps: Stamps) -> Iterator[slice]:
        """Yield the stretches between jumps back in time; at each jump the filters begin anew."""
        start = 0
        while start < len(stamps):
            before = stamps[start] if self._newest is None else self._newest
            newest = np.maximum.accumulate(np.concatenate([[before], stamps[start:]]))
            jumps = np.flatnonzero(stamps[start:] < newest[:-1] - TIME_JUMP)
            stop = start + int(jumps[0]) if len(jumps) else len(stamps)
            self._newest = int(newest[stop - start])
            if stop > start:
                yield slice(start, stop)
            if stop < len(stamps):
                self.jumps_back += 1
                self._reset_filters()
            start = stop

    def _filter(self, stamps: Stamps, corrected: NDArray[np.float64], innovation: NDArray[np.float64]) -> None:
        """Run the Kalman stage in place over one stretch (m, c)."""
        for column, stage in enumerate(self._filters):
            if stage is not None:
                corrected[:, column], innovation[:, column] = stage.run(stamps, corrected[:, column])
