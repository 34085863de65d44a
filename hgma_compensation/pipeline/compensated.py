"""What the pipeline makes of samples."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Compensated:
    """Result for n samples and c channels, in the order of the calibration.

    values: compensated, (n, c). drift: what was subtracted, (n, c). innovation: of the Kalman stage,
    (n, c), 0 where it is off. features: (n, 3) before clamping; the middle of the calibrated range where
    the temperature is missing. inside_range: (n,). status: (n,) TemperatureStatus. uncertainty: standard deviation
    of the drift, (n, c).
    """

    values: NDArray[np.float64]
    drift: NDArray[np.float64]
    innovation: NDArray[np.float64]
    features: NDArray[np.float64]
    inside_range: NDArray[np.bool_]
    status: NDArray[np.uint8]
    uncertainty: NDArray[np.float64]

    def added_variance(self, row: int) -> NDArray[np.float64] | None:
        """Return by what (c,) a sample's variances grow; None where the temperature is what the calibration knows."""
        return self.uncertainty[row] ** 2 if self.status[row] else None


def joined(parts: Sequence[Compensated]) -> Compensated:
    """Return the results of consecutive samples as one."""
    return Compensated(
        *(np.concatenate([getattr(part, name) for part in parts]) for name in Compensated.__dataclass_fields__)
    )
