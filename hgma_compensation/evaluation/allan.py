"""Allan deviation of a recording, by allantools, and the two figures read off it (IEEE Std 952)."""

from dataclasses import dataclass

import allantools
import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import NANOSECONDS, Stamps

FLICKER_FLOOR = float(np.sqrt(2.0 * np.log(2.0) / np.pi))
"""ADEV of flicker noise over its bias instability B (IEEE Std 952-1997, eq. C.9): 0.664."""

FEWEST_SAMPLES = 100
LEAST_CLUSTERS = 8
"""Averages below which the deviation at a τ is too uncertain to read a minimum from."""


@dataclass(frozen=True)
class AllanCurve:
    """taus: s, deviations: in the channel's unit, each (k,), overlapping estimator."""

    taus: NDArray[np.float64]
    deviations: NDArray[np.float64]


def allan_curve(stamps: Stamps, values: NDArray[np.float64]) -> AllanCurve | None:
    """Return the overlapping Allan deviation of samples (n,) at stamps (ns), None for too few samples.

    The samples are taken as evenly spaced at their median interval.
    """
    interval = median_interval(stamps)
    if len(stamps) < FEWEST_SAMPLES or interval <= 0.0:
        return None
    longest = len(values) // LEAST_CLUSTERS
    averaging = np.unique(np.geomspace(1, longest, 40).astype(int))
    taus, deviations, _, _ = allantools.oadev(values, rate=1.0 / interval, data_type="freq", taus=averaging * interval)
    return AllanCurve(np.asarray(taus), np.asarray(deviations))


def median_interval(stamps: Stamps) -> float:
    """Return the median time (s) from one of the stamps (n,) to the next, 0 for fewer than two."""
    return float(np.median(np.diff(stamps))) / NANOSECONDS if len(stamps) > 1 else 0.0


def velocity_random_walk(curve: AllanCurve) -> float:
    """Return N in unit/√Hz: σ(τ)·√τ at the shortest τ, where white noise rules."""
    return float(curve.deviations[0] * np.sqrt(curve.taus[0]))


def bias_instability(curve: AllanCurve) -> float:
    """Return B in the channel's unit: the smallest deviation over 0.664.

    An upper bound where the curve has no flat part; during an oven test the drift itself raises it.
    """
    return float(curve.deviations.min() / FLICKER_FLOOR)
