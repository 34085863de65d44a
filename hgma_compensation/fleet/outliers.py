"""Sensors unlike the rest of their fleet."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.fleet.figures import Worse

FEWEST = 8
"""Sensors below which nothing is said: the median deviation of fewer tells too little."""

THRESHOLD = 3.5
NORMAL = 0.6745
"""Median deviation of a normal distribution of standard deviation 1."""


def robust_scores(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 0.6745 (x − median) / MAD of values (n,), NaN where fewer than FEWEST are finite or the MAD is 0.

    Iglewicz and Hoaglin 1993, "How to detect and handle outliers", who call 3.5 and more an outlier. MAD: median of the
    distances from the median, which up to half of the values cannot move far.
    """
    finite = values[np.isfinite(values)]
    if len(finite) < FEWEST:
        return np.full(len(values), np.nan)
    middle = float(np.median(finite))
    deviation = float(np.median(np.abs(finite - middle)))
    if deviation == 0.0:
        return np.full(len(values), np.nan)
    return NORMAL * (values - middle) / deviation


def outlying(scores: NDArray[np.float64], worse: Worse) -> NDArray[np.bool_]:
    """Return for each score (n,) whether it is an outlier on the side where the figure is worse, (n,)."""
    if worse is Worse.DOWN:
        scores = -scores
    elif worse is Worse.AWAY:
        scores = np.abs(scores)
    with np.errstate(invalid="ignore"):
        return np.asarray(scores > THRESHOLD)
