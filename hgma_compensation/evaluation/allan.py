"""Allan deviation of a recording, and the two figures read off it (IEEE Std 952).

The estimator is that of allantools' oadev, which takes several times the memory of the samples; here the squares are
summed in pieces, so that the order of summation is another one: equal to 1e-12.
"""

from dataclasses import dataclass
from math import fsum

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import NANOSECONDS, Stamps

FLICKER_FLOOR = float(np.sqrt(2.0 * np.log(2.0) / np.pi))
"""ADEV of flicker noise over its bias instability B (IEEE Std 952-1997, eq. C.9): 0.664."""

FEWEST_SAMPLES = 100
LEAST_CLUSTERS = 8
"""Averages below which the deviation at a τ is too uncertain to read a minimum from."""

AT_ONCE = 1 << 14
"""Differences that are squared and summed at once: they stay in the cache."""


@dataclass(frozen=True)
class AllanCurve:
    """taus: s, deviations: in the channel's unit, each (k,), overlapping estimator."""

    taus: NDArray[np.float64]
    deviations: NDArray[np.float64]


def allan_curve(stamps: Stamps, values: NDArray[np.float64]) -> AllanCurve | None:
    """Return the overlapping Allan deviation of samples (n,) at stamps (ns), None for too few samples.

    The samples are taken as evenly spaced at their median interval.
    """
    return curve_in_place(median_interval(stamps), values.copy())


def curve_in_place(interval: float, values: NDArray[np.float64]) -> AllanCurve | None:
    """Return the curve of samples (n,), one every ``interval`` s, and use up their memory."""
    if len(values) < FEWEST_SAMPLES or interval <= 0.0:
        return None
    averaging = np.unique(np.geomspace(1, len(values) // LEAST_CLUSTERS, 40).astype(int))
    rate = 1.0 / interval
    # About its mean: the integral of a series stays small then, and keeps its digits.
    values -= np.mean(values)
    np.cumsum(values, out=values)
    values *= 1.0 / rate
    deviations = [_overlapping(values, factor) * rate for factor in averaging.tolist()]
    return AllanCurve(np.asarray(averaging / rate), np.array(deviations))


def _overlapping(phase: NDArray[np.float64], factor: int) -> float:
    """Return the deviation at ``factor`` intervals (NIST SP 1065, eq. 11) times one of them; phase: (n,) integral."""
    count = len(phase) + 1 - 2 * factor
    # The first difference begins at the integral of no sample, 0, which is not in the array.
    squares = [float((phase[2 * factor - 1] - 2.0 * phase[factor - 1]) ** 2)]
    for start in range(0, count - 1, AT_ONCE):
        stop = min(start + AT_ONCE, count - 1)
        late, middle, early = (phase[start + back : stop + back] for back in (2 * factor, factor, 0))
        difference = late - 2.0 * middle + early
        squares.append(float(np.sum(difference * difference)))
    return float(np.sqrt(fsum(squares) / (2.0 * count)) / factor)


def median_interval(stamps: Stamps) -> float:
    """Return the median time (s) from one of the stamps (n,) to the next, 0 for fewer than two."""
    return median_step(np.diff(stamps))


def median_step(steps: Stamps) -> float:
    """Return the median (s) of steps (n,) in ns, 0 for none; brings them into another order."""
    return float(np.median(steps, overwrite_input=True)) / NANOSECONDS if len(steps) else 0.0


def velocity_random_walk(curve: AllanCurve) -> float:
    """Return N in unit/√Hz: σ(τ)·√τ at the shortest τ, where white noise rules."""
    return float(curve.deviations[0] * np.sqrt(curve.taus[0]))


def bias_instability(curve: AllanCurve) -> float:
    """Return B in the channel's unit: the smallest deviation over 0.664.

    An upper bound where the curve has no flat part; during an oven test the drift itself raises it.
    """
    return float(curve.deviations.min() / FLICKER_FLOOR)
