"""Time as integer nanoseconds, differences as seconds.

A stamp since 1970 in float64 seconds resolves 240 ns only, which is a quarter of the sampling
interval at 1 MHz. Stamps therefore stay integers, and only differences become floats.
"""

import numpy as np
from numpy.typing import NDArray

Stamps = NDArray[np.int64]
NANOSECONDS = 1_000_000_000


def to_nanoseconds(seconds: float) -> int:
    """Return a duration in s as whole nanoseconds."""
    return round(seconds * NANOSECONDS)


def seconds_between(later: Stamps, earlier: Stamps | int) -> NDArray[np.float64]:
    """Return ``later - earlier`` in s, exact to the nanosecond before the one rounding to float64."""
    return np.asarray((later - earlier) * 1e-9, dtype=np.float64)
