"""Which of CHANNELS a calibration covers, and which it reads."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import AXES, CHANNELS, columns_of

Array = NDArray[np.float64]


class Columns:
    """calibrated: (c,) of CHANNELS, in the order of the calibration. read: those that must be finite.

    axes: which of the acceleration's axes are calibrated, if these are all there is, and nothing else is read, and they
    can be said by a slice; None otherwise.
    """

    def __init__(self, calibration: Calibration) -> None:
        """Take the channels of a calibration, and those that its effects read."""
        self.calibrated, self.read = columns_of(calibration.names), columns_of(calibration.channels_read)
        self.axes = _axes(self.calibrated) if set(self.calibrated) == set(self.read) else None

    def __len__(self) -> int:
        """Return c."""
        return len(self.calibrated)

    def of(self, imu: Array) -> Array:
        """Return the calibrated channels (n, c) out of columns CHANNELS (n, 6), a view where they lie side by side."""
        first, last = self.calibrated[0], self.calibrated[-1]
        if self.calibrated == list(range(first, last + 1)):
            return imu[:, first : last + 1]
        return imu[:, self.calibrated]

    def widened(self, values: Array) -> Array:
        """Return values (n, c) as columns of CHANNELS (n, 6), the others 0."""
        wide = np.zeros((len(CHANNELS), len(values))).T
        wide[:, self.calibrated] = values
        return wide


def _axes(columns: list[int]) -> slice | None:
    """Return columns of CHANNELS as a slice of AXES, None where they are none."""
    step = columns[1] - columns[0] if len(columns) > 1 else 1
    inside = slice(columns[0], columns[-1] + 1, step) if step > 0 and columns[-1] < len(AXES) else slice(0)
    return inside if list(range(len(AXES)))[inside] == columns else None
