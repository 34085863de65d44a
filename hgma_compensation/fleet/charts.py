"""Pictures of a fleet: how each figure is spread, and what is left of how much."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from hgma_compensation.channels import unit_of
from hgma_compensation.fleet.figures import FIGURES, Figure, Worse
from hgma_compensation.fleet.summary import Summary, Unit
from hgma_compensation.quantities import shown_unit
from hgma_compensation.report.pictures.canvas import Chart, instant, label, level, logarithmic
from hgma_compensation.report.pictures.svg import COLOURS
from hgma_compensation.report.words import number, unit

Array = NDArray[np.float64]
MOST_BARS, FEWEST_BARS = 40, 8

LEFT = "residual_peak_to_peak"
"""Figure that is drawn over the raw span."""


def histogram(summary: Summary, channel: str, figure: Figure) -> Chart | None:
    """Return how a figure is spread over the sensors, with its limit; None where no sensor has it."""
    known = np.array([value for value in summary.values(channel, figure.name) if value is not None])
    if not len(known):
        return None
    unit_text = shown_unit(figure.unit(unit_of(channel)))
    chart = Chart(
        figure.title[0].upper() + figure.title[1:], f"Median {number(float(np.median(known)))} {unit_text}.", height=2.2
    )
    axes = chart.axes[0]
    axes.hist(known, bins=bars(known), color=COLOURS["after"], alpha=0.85, linewidth=0.0)
    limit = summary.limits.of(channel).get(figure.name)
    if limit is not None:
        chart.key("heat", "dash", f"limit {limit:g} {unit_text}".rstrip())
        both = figure.worse is Worse.AWAY
        for x in (limit, -limit):
            if (x == limit and not (both and known.max() < 0.0)) or (x != limit and both and known.min() < 0.0):
                instant(axes, x, "heat")
    label(axes, f"{figure.title}, {unit_text}" if unit_text else figure.title, "sensors")
    axes.locator_params(axis="x", nbins=5)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=5, integer=True))
    return chart


def bars(values: Array) -> int:
    """Return the number of bars by the rule of Freedman and Diaconis 1981, within what can be seen."""
    low, high = np.percentile(values, [25, 75])
    width = 2.0 * float(high - low) / len(values) ** (1.0 / 3.0)
    wanted = int(np.ceil(np.ptp(values) / width)) if width > 0.0 else FEWEST_BARS
    return int(np.clip(wanted, FEWEST_BARS, MOST_BARS))


def span_against_residual(summary: Summary, channel: str) -> Chart:
    """Return what compensation leaves of each sensor over what the sensor drifts."""
    chart = Chart("What is left of how much", "Each point is a sensor, on data that it was not fitted to.", height=2.6)
    axes = chart.axes[0]
    groups: tuple[tuple[str, str, str, Sequence[Unit]], ...] = (
        ("after", "o", "sensor", [u for u in summary.units if not _marked(u, channel)]),
        ("heat", "D", "breaks a limit, or outlier", [u for u in summary.units if _marked(u, channel)]),
    )
    for colour, marker, text, units in groups:
        points = [p for p in (_point(u, channel) for u in units) if p is not None]
        if points:
            x, y = zip(*points, strict=True)
            axes.plot(x, y, marker, color=COLOURS[colour], markersize=4.0, markeredgewidth=0.0, alpha=0.85)
            chart.key(colour, "dot", text)
    limit = summary.limits.of(channel).get(LEFT)
    if limit is not None:
        chart.key("heat", "dash", f"limit {limit:g} {unit(channel)}")
        axes.axhline(limit, color=COLOURS["heat"], linewidth=0.8, linestyle=(0, (3, 2)))
    if not axes.lines:
        level(axes)
    elif min(axes.get_ylim()) > 0.0 and axes.dataLim.height > 0.0 and axes.dataLim.y1 > 20.0 * axes.dataLim.y0:
        logarithmic(axes, ("y",))
    label(axes, f"raw span, {unit(channel)}", f"residual peak to peak, {unit(channel)}")
    return chart


def _marked(one: Unit, channel: str) -> bool:
    return channel in {*(limit.channel for limit in one.broken), *(outlier.channel for outlier in one.outliers)}


def _point(one: Unit, channel: str) -> tuple[float, float] | None:
    figures = one.status.channels.get(channel, {})
    x, y = figures.get("raw_span"), figures.get(LEFT)
    return None if x is None or y is None else (x, y)


def charts_of(summary: Summary, channel: str) -> list[Chart]:
    """Return all pictures of a channel."""
    spread = [histogram(summary, channel, figure) for figure in FIGURES]
    return [span_against_residual(summary, channel), *(chart for chart in spread if chart is not None)]
