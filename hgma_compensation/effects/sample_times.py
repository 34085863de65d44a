"""Times between samples of the accelerometer, as the memories of it keep them."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import NANOSECONDS, Stamps, seconds_between

Array = NDArray[np.float64]

GAP = 10.0
"""Longest time between samples, s, over which the acceleration before says anything about that after."""

NEVER = -1e9
"""Second of the stamp before the first: further back than a gap."""


def seconds_before(last: Array, stamps: Stamps) -> Array:
    """Return the seconds (n,) from each sample's predecessor; last: (2,) s and ns of the first one's."""
    first = int(last[0]) * NANOSECONDS + int(last[1])
    return seconds_between(stamps, np.concatenate([np.array([first], dtype=np.int64), stamps[:-1]]))


def put_halves(states: Array, stamps: Stamps) -> None:
    """Write stamps as s and ns, which a float64 holds exactly, into the last two columns of states (n, m)."""
    states[:, -2] = seconds = stamps // NANOSECONDS
    states[:, -1] = stamps - seconds * NANOSECONDS


def factors(keeps: Array) -> float | Array:
    """Return what a low-pass keeps at each sample (n,) as one number where it is one, for which there is a fast way."""
    return float(keeps[0]) if len(keeps) and bool((keeps == keeps[0]).all()) else keeps
