"""Allan deviation of the hold-out, before and after."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.errors_held_out import HeldOutError
from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.evaluation.allan_confidence import AllanTable, dense_table
from hgma_compensation.report.pictures.canvas import Chart, label, line, logarithmic
from hgma_compensation.report.pictures.svg import COLOURS
from hgma_compensation.report.words import unit

Array = NDArray[np.float64]

FEWEST, MOST = 100, 100_000
"""Samples below which there is no curve, and to which more of them are averaged first."""

SILENT = 0.5
"""Share of samples without a value from which on there is no curve."""


def allan_chart(channel: ChannelDiagnosis) -> list[Chart]:
    """Return the overlapping Allan deviation of the samples of the hold-out, with its 95 % intervals."""
    chart = Chart(
        "Allan deviation on the hold-out",
        "Overlapping estimator, shaded: 95 % confidence. A bump at the time of a temperature cycle is drift that is "
        "left; real acceleration in the hold-out counts too.",
    )
    changed = channel.after is not channel.before
    curves = [("before", "before" if changed else "compensated", channel.before)]
    if changed:
        curves.append(("after", "after", channel.after))
    for colour, text, error in curves:
        found = _table(error)
        if found is None:
            return []
        chart.axes[0].fill_between(
            found.taus, found.lower, found.upper, color=COLOURS[colour], alpha=0.22, linewidth=0.0
        )
        line(chart.axes[0], found.taus, found.deviations, colour)
        chart.key(colour, "line", text)
    logarithmic(chart.axes[0])
    label(chart.axes[0], "averaging time τ, s", f"Allan deviation, {unit(channel.name)}")
    return [chart]


def _table(error: HeldOutError) -> AllanTable | None:
    samples = error.samples
    if len(samples) < FEWEST or samples.known < SILENT:
        return None
    interval = samples.interval
    if interval <= 0.0:
        return None
    size, means = samples.means(MOST)
    found = dense_table(means, interval * size)
    return found.select(np.isfinite(found.lower) & np.isfinite(found.upper) & (found.lower > 0.0))
