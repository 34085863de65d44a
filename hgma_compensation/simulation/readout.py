"""Range and resolution of the converter."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.simulation.description import Axis


def digitise(values: NDArray[np.float64], axis: Axis) -> NDArray[np.float64]:
    """Return values (n,) clipped to ±full_scale, then rounded to the LSB; a code beyond full scale does not exist."""
    clipped = np.clip(values, -axis.full_scale, axis.full_scale)
    if axis.lsb == 0.0:
        return np.asarray(clipped)
    largest = np.floor(axis.full_scale / axis.lsb)
    return np.asarray(axis.lsb * np.clip(np.rint(clipped / axis.lsb), -largest, largest))
