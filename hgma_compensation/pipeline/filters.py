"""The Kalman stages of a calibration's channels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration
from hgma_compensation.kalman.consistency import Consistency
from hgma_compensation.stamps import Stamps

if TYPE_CHECKING:
    from hgma_compensation.kalman.stage import KalmanStage

Array = NDArray[np.float64]


class Filters:
    """A stage for each channel that has one. used: whether any has."""

    def __init__(self, calibration: Calibration) -> None:
        """Start before the first sample."""
        self._stages = [_stage(channel) for channel in calibration.channels]
        self.used = any(stage is not None for stage in self._stages)

    @property
    def openings(self) -> int:
        """How often real acceleration has opened the gate of any channel."""
        return sum(stage.openings for stage in self._stages if stage is not None)

    def take_consistency(self) -> list[Consistency]:
        """Return for each channel what its innovations were like since the last call."""
        return [Consistency() if stage is None else stage.take_consistency() for stage in self._stages]

    def reset(self) -> None:
        """Begin anew."""
        for stage in filter(None, self._stages):
            stage.reset()

    def set_back(self, stamp: int) -> None:
        """Go on at a stamp (ns) after the accelerometer's clock was corrected."""
        for stage in filter(None, self._stages):
            stage.set_back(stamp)

    def run(self, stamps: Stamps, unfiltered: Array) -> tuple[Array, Array]:
        """Return filtered samples and innovations (n, c) of one stretch, unfiltered (n, c) at stamps (n,) in ns."""
        corrected, innovation = unfiltered.copy(order="K"), np.zeros_like(unfiltered)
        for column, stage in enumerate(self._stages):
            if stage is not None:
                corrected[:, column], innovation[:, column] = stage.run(stamps, corrected[:, column])
        return corrected, innovation


def _stage(channel: ChannelCalibration) -> KalmanStage | None:
    if channel.filter.noise is None:
        return None
    # Ten modules, for which a calibration without filter does not wait.
    from hgma_compensation.kalman.stage import KalmanStage

    return KalmanStage(channel.filter, channel.reference)
