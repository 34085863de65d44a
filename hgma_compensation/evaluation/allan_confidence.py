"""Overlapping Allan deviation at chosen averaging times, with its slope and its confidence interval.

Equivalent degrees of freedom after Greenhall and Riley, "Uncertainty of stability variances based on
finite differences", PTTI 2003, and the chi-square interval of NIST SP 1065, eq. 45, both by allantools.
The noise type that they need is told by the local slope: acceleration stands where allantools has
fractional frequency, so white noise (slope -1/2) is its α = 0, flicker (0) α = -1, random walk (+1/2) α = -2.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import allantools
import numpy as np
from allantools.ci import confidence_interval, edf_greenhall
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONFIDENCE = 0.95
FEWEST_CLUSTERS = 5
"""The longest τ is the record's length over this."""

DENSE = 24
"""Points per decade of a curve that slopes are read from."""

HALF_WINDOW = 0.125
"""Decades on either side of a τ over which its slope is fitted."""


@dataclass(frozen=True)
class AllanTable:
    """taus: s. deviations, lower, upper: in the values' unit, the interval of CONFIDENCE. slopes: d log σ / d log τ.

    freedom: equivalent degrees of freedom. All of shape (k,).
    """

    taus: Array
    deviations: Array
    lower: Array
    upper: Array
    slopes: Array
    freedom: Array

    def select(self, rows: NDArray[np.bool_]) -> "AllanTable":
        """Return the rows that are true."""
        return AllanTable(*(getattr(self, name)[rows] for name in AllanTable.__dataclass_fields__))


def allan_table(values: Array, interval: float, taus: Sequence[float] | Array) -> AllanTable:
    """Return the table of values (n,), one every ``interval`` s, at those of the taus (s) that the record allows."""
    longest = len(values) * interval / FEWEST_CLUSTERS
    allowed = [tau for tau in taus if interval * (1.0 - 1e-9) <= tau <= longest]
    averaging = np.unique(np.rint(np.array(allowed) / interval).astype(int)) if allowed else np.empty(0, dtype=int)
    dense = dense_averaging(len(values))
    grid = np.unique(np.concatenate([averaging, dense]))
    all_taus, all_deviations = _deviations(values, interval, grid)
    rows = np.searchsorted(grid, averaging)
    slopes = local_slopes(all_taus, all_deviations, all_taus[rows])
    freedom = np.array(
        [degrees_of_freedom(s, int(m), len(values)) for s, m in zip(slopes, averaging, strict=True)], dtype=float
    )
    deviations = all_deviations[rows]
    limits = [confidence_interval(d, f, CONFIDENCE) for d, f in zip(deviations, freedom, strict=True)]
    lower, upper = np.array(limits).reshape(-1, 2).T
    return AllanTable(all_taus[rows], deviations, lower, upper, slopes, freedom)


def dense_table(values: Array, interval: float) -> AllanTable:
    """Return the table at DENSE points per decade, from one sample to all that the record allows."""
    return allan_table(values, interval, np.asarray(dense_averaging(len(values)) * interval, dtype=np.float64))


def dense_averaging(count: int) -> NDArray[np.int64]:
    """Return averaging factors (k,), DENSE to the decade where whole numbers are that dense."""
    longest = max(count // FEWEST_CLUSTERS, 1)
    points = max(2, round(np.log10(longest) * DENSE) + 1)
    return np.unique(np.rint(np.geomspace(1, longest, points)).astype(np.int64))


def local_slopes(taus: Array, deviations: Array, at: Array) -> Array:
    """Return d log σ / d log τ, least squares over HALF_WINDOW decades on either side, at each of ``at`` (k,)."""
    x, y = np.log10(taus), np.log10(deviations)
    slopes = np.empty(len(at))
    for row, centre in enumerate(np.log10(at)):
        distance = np.abs(x - centre)
        near = distance <= HALF_WINDOW
        if near.sum() < 3:  # At the shortest τ whole numbers of samples are far apart.
            near = np.isin(np.arange(len(x)), np.argsort(distance, kind="stable")[:3])
        slopes[row] = np.polyfit(x[near], y[near], 1)[0] if near.sum() > 1 else -0.5
    return slopes


def degrees_of_freedom(slope: float, averaging: int, count: int) -> float:
    """Return the equivalent degrees of freedom of the overlapping estimator over ``count`` samples.

    A slope steeper than white noise's is taken for chance: at long τ the slope is itself uncertain, and
    what α = 1 or 2 would add to the certainty is not there.
    """
    alpha = int(np.clip(np.rint(-2.0 * slope - 1.0), -2, 0))
    return float(edf_greenhall(alpha, 2, averaging, count + 1, overlapping=True, modified=False))


def _deviations(values: Array, interval: float, averaging: NDArray[np.int64]) -> tuple[Array, Array]:
    taus, deviations, _, _ = allantools.oadev(values, rate=1.0 / interval, data_type="freq", taus=averaging * interval)
    if len(taus) != len(averaging):
        raise ValueError(f"{len(values)} samples are too few for averaging over {int(averaging.max())} of them")
    return np.asarray(taus), np.asarray(deviations)
