"""Heating, cooling, soaking: which blocks, which colour."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.report.pictures.canvas import Chart

Array = NDArray[np.float64]

STILL = 0.15
"""Share of a fast ramp's rate below which the temperature counts as held."""

LEAST_STILL = 0.05 / 60.0
"""°C/s: slower than that is held whatever the ramps."""

DIRECTIONS = (("heat", "heating", 1), ("cool", "cooling", -1), ("soak", "soak", 0))


def still_rate(rate: Array) -> float:
    """Return the rate in °C/s below which blocks with rates (n,) are soaking."""
    return max(STILL * float(np.quantile(np.abs(rate), 0.95)) if len(rate) else 0.0, LEAST_STILL)


def direction(rate: Array) -> NDArray[np.int64]:
    """Return +1 heating, -1 cooling, 0 soak for rates (n,) in °C/s."""
    return np.where(np.abs(rate) < still_rate(rate), 0, np.sign(rate)).astype(np.int64)


def name_directions(chart: Chart) -> None:
    """Put the colours of the directions into the keys of a chart."""
    for colour, text, _ in DIRECTIONS:
        chart.key(colour, "dot", text)
