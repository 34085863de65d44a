"""Long series drawn with few points that keep every peak."""

import numpy as np
from numpy.typing import NDArray

MOST = 2000
"""Points of a series that are drawn."""


def extremes(values: NDArray[np.float64], most: int = MOST) -> NDArray[np.int64]:
    """Return the rows of values (n,) to draw, increasing: all, or the least and the largest of each of most / 2 bins.

    Bins are of equal count, in the order of the rows. Values that are not finite are drawn only where all are.
    """
    if len(values) <= most:
        return np.arange(len(values))
    edges = np.linspace(0, len(values), max(most // 2, 1) + 1).astype(np.int64)
    finite = np.isfinite(values)
    low, high = np.where(finite, values, np.inf), np.where(finite, values, -np.inf)
    rows = [
        row
        for start, stop in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True)
        for row in (start + int(np.argmin(low[start:stop])), start + int(np.argmax(high[start:stop])))
    ]
    return np.unique(np.array(rows, dtype=np.int64))
