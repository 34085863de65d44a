"""The noise figures of Zhu et al. 2019 in that paper's own terms and units.

Its Table 3 has an "acceleration random walking" in g/h/√Hz and a "bias stability" in g/h. Read as for a
gyroscope's rate, a g "per hour" is a g times 3600: 17130 is 4.76 g/√Hz and 4720 is 1.31 g. Here

    N = σ(1 s) · √(1 s) · 3600        σ: overlapping Allan deviation of a still record
    B = min σ(τ) / 0.664 · 3600       τ up to a fifteenth of the first hour

Both are read wherever the curve happens to be, filter or not, because that is what the table must have
done: 57.27 g/h is 0.0159 g, below any flicker floor of a sensor that had 1.31 g before. They compare runs of
one kind; ``noise_figures`` has the figures that mean something by themselves.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.evaluation.allan import FLICKER_FLOOR
from hgma_compensation.evaluation.allan_confidence import allan_table, dense_table
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY

SECONDS_PER_HOUR = 3600.0
READ_AT = 1.0
"""τ of N, s."""

SHORT_RECORD, CLUSTERS = 3600.0, 15
"""s of the still record that B is read over, and the share of it that is the longest τ.

With them white noise of 4.76 g/√Hz and flicker noise of B = 1.31 g read 4720 g/h in the mean of many records
(and 660 more or less in one): white noise still in the curve raises the minimum, and that it is one lowers it.
"""

PAPER = {
    "original": (17130.0, 4720.0, 5367.0),
    "last row": (765.3, 57.27, 385.0),
}
"""N in g/h/√Hz, B in g/h, span of the drift in g, of the paper's first and last rows."""


@dataclass(frozen=True)
class PaperFigures:
    """acceleration_random_walking: g/h/√Hz. bias_stability: g/h."""

    acceleration_random_walking: float
    bias_stability: float


def paper_figures(values: NDArray[np.float64], interval: float) -> PaperFigures:
    """Return the figures of values (n,) in m/s² of a still sensor, one every ``interval`` s (at most 1 s)."""
    short = values[: round(SHORT_RECORD / interval)]
    to_paper = SECONDS_PER_HOUR / STANDARD_GRAVITY
    at_one_second = allan_table(short, interval, [READ_AT])
    if not len(at_one_second.taus):
        raise ValueError(f"a record of {len(short) * interval:g} s at {1 / interval:g} Hz has no deviation at 1 s")
    dense = dense_table(short, interval)
    least = float(dense.deviations[dense.taus * CLUSTERS <= len(short) * interval].min())
    return PaperFigures(float(at_one_second.deviations[0]) * to_paper, least / FLICKER_FLOOR * to_paper)
