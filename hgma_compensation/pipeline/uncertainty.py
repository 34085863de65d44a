"""How far the drift that is subtracted may be off, where the temperature is not what the calibration knows."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.pipeline.status import TemperatureStatus

Array = NDArray[np.float64]

POINTS = 17
"""Per feature, from which the span of the drift over the calibrated range is read."""

WHOLE_RANGE = 2.0
"""Half widths that a temperature of which nothing is known any more can lie away: it stays inside the range."""


class DriftUncertainty:
    """Standard deviation of the drift, in each channel's unit.

    With a usable temperature it is the calibration's own error. Otherwise each feature i that is unknown, or outside,
    by eᵢ half widths of the calibrated range adds (hᵢ·eᵢ)², hᵢ being half the drift's span over feature i through the
    middle of the range: the drift goes on beyond the range as steeply as it does inside on average. A temperature that
    is held goes off by at most the fastest rate of the calibrated range, and its rate is known less and less up to the
    prediction horizon.
    """

    def __init__(self, calibration: Calibration) -> None:
        """Read the spans off a calibration."""
        box = calibration.calibrated_range
        self._lower, self._upper = box.lower, box.upper
        # A feature that never varied has no width, and no span of the drift either.
        self._half = np.where(box.upper > box.lower, 0.5 * (box.upper - box.lower), np.inf)
        self._fastest = float(np.abs([box.lower[1], box.upper[1]]).max())
        self._horizon = calibration.features.prediction_horizon
        self._error = np.array([channel.error.unseen for channel in calibration.channels])
        points = np.repeat(box.middle[None], POINTS * 3, axis=0)
        for feature in range(3):
            rows = slice(feature * POINTS, (feature + 1) * POINTS)
            points[rows, feature] = np.linspace(box.lower[feature], box.upper[feature], POINTS)
        drift = np.stack([channel.drift.evaluate(points) for channel in calibration.channels])
        self._spans = 0.5 * np.ptp(drift.reshape(len(drift), 3, POINTS), axis=2)

    def evaluate(self, features: Array, age: Array, status: NDArray[np.uint8]) -> Array:
        """Return the standard deviation (n, c); features: (n, 3), age: (n,) s of the thermistor sample in use."""
        if not status.any():
            return np.broadcast_to(self._error, (len(status), len(self._error)))
        excess = self._excess(features, age, status)
        # Added up feature by feature: a matrix product's last bit depends on how many samples there are.
        variance = np.broadcast_to(self._error**2, (len(status), len(self._error))).copy()
        for feature in range(3):
            variance += (excess[:, feature, None] * self._spans[:, feature]) ** 2
        return np.where((status == TemperatureStatus.OK)[:, None], self._error, np.sqrt(variance))

    def _excess(self, features: Array, age: Array, status: NDArray[np.uint8]) -> Array:
        """Return by how many half widths of the range each feature may be off, (n, 3)."""
        outside = np.maximum(self._lower - features, features - self._upper)
        excess = np.maximum(outside, 0.0) / self._half
        unknown = np.isinf(age)
        held = ((status == TemperatureStatus.STALE) | (status == TemperatureStatus.INVALID)) & ~unknown
        moved = np.minimum(self._fastest * age[held] / self._half[0], WHOLE_RANGE)
        lost = np.minimum(age[held], self._horizon) / self._horizon
        excess[held] += np.column_stack([moved, lost, lost])
        excess[status == TemperatureStatus.SETTLING, 2] += 1.0
        excess[unknown] = 1.0
        return excess
