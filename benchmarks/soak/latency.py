"""How long samples take through a node, with and without something else going on in it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

QUANTILES = {"median": 50.0, "p99": 99.0, "p99_9": 99.9, "max": 100.0}


def latency_figures(
    stamps: Sequence[int], published: Sequence[int], busy: NDArray[np.bool_], quiet: NDArray[np.bool_]
) -> dict[str, dict[str, Any]]:
    """Return quantiles in ms of the time from the sample's stamp to its output, and of that between two outputs.

    stamps, published: (n,) ns. busy, quiet: (n,) samples of each of the two kinds.
    """
    latency = (np.array(published) - np.array(stamps)) * 1e-6
    gaps = np.diff(np.array(published), prepend=published[0]) * 1e-6
    return {
        f"{name}_ms_{kind}": _quantiles(values[rows])
        for name, values in (("latency", latency), ("gap", gaps))
        for kind, rows in (("loading", busy), ("quiet", quiet))
    }


def _quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    if not len(values):
        return {}
    return {name: round(float(np.percentile(values, quantile)), 3) for name, quantile in QUANTILES.items()}
