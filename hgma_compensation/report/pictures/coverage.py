"""Where in temperature and rate there is data."""

import numpy as np

from hgma_compensation.drift.inputs import Array
from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.report.pictures.canvas import Chart, cloud, label, line
from hgma_compensation.report.pictures.decimate import MOST
from hgma_compensation.report.pictures.ramps import DIRECTIONS, direction, name_directions


def coverage_chart(features: Array, box: CalibratedRange) -> Chart:
    """Return the means (n, 3) that were fitted, in temperature and rate, and the range that counts as calibrated."""
    chart = Chart(
        "Temperature and rate",
        "Dashed: the calibrated range. Inside of it, where there are no dots, the model interpolates; outside of it "
        "the drift is held at the edge.",
        height=3.2,
    )
    name_directions(chart)
    axes = chart.axes[0]
    rows = np.arange(0, len(features), max(1, -(-len(features) // MOST)))
    way = direction(features[:, 1])[rows]
    for colour, _, sign in DIRECTIONS:
        cloud(axes, features[rows, 0][way == sign], 60.0 * features[rows, 1][way == sign], colour, alpha=0.6)
    (left, bottom), (right, top) = box.lower[:2].tolist(), box.upper[:2].tolist()
    line(
        axes,
        np.array([left, right, right, left, left]),
        60.0 * np.array([bottom, bottom, top, top, bottom]),
        "rival",
        "--",
        1.2,
    )
    chart.key("rival", "dash", "calibrated range")
    label(axes, "temperature, °C", "temperature rate, °C/min")
    return chart
