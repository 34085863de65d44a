"""The error on the hold-out, before and after."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from hgma_compensation.diagnosis.errors_held_out import HeldOutError
from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.report.pictures.canvas import Chart, cloud, label, level, note, thinned
from hgma_compensation.report.pictures.ramps import DIRECTIONS, direction, name_directions
from hgma_compensation.report.pictures.svg import COLOURS
from hgma_compensation.report.words import number, unit

Array = NDArray[np.float64]


def residual_charts(channel: ChannelDiagnosis) -> list[Chart]:
    """Return error against time and temperature: before and after on one scale, then what is left on its own."""
    changed = channel.after is not channel.before
    charts = [_both(channel, name) for name in ("time", "temperature")] if changed else []
    return [*charts, *(_left(channel, name, changed) for name in ("time", "temperature"))]


def _both(channel: ChannelDiagnosis, variable: str) -> Chart:
    chart = Chart(f"Error against {variable}", "Both on the same scale.", panels=2, height=3.8)
    name_directions(chart)
    for axes, error, text in zip(chart.axes, (channel.before, channel.after), ("before", "after"), strict=True):
        _draw(axes, error, variable)
        note(axes, f"{text}: {number(error.rms)} {unit(channel.name)} RMS")
        label(axes, y=unit(channel.name))
    label(chart.axes[-1], x=_name(variable))
    return chart


def _left(channel: ChannelDiagnosis, variable: str, changed: bool) -> Chart:
    title = f"What is left, against {variable}" if changed else f"Error against {variable}"
    chart = Chart(title, "On its own scale. The band is the white noise of such a mean, ±2σ.")
    name_directions(chart)
    chart.key("band", "area", "noise")
    axes, noise = chart.axes[0], 2.0 * channel.after.noise
    axes.axhspan(-noise, noise, color=COLOURS["band"], linewidth=0.0, alpha=0.18)
    _draw(axes, channel.after, variable)
    label(axes, x=_name(variable), y=f"error, {unit(channel.name)}")
    return chart


def _draw(axes: Axes, error: HeldOutError, variable: str) -> None:
    rows = thinned(len(error.time))
    x = (error.time / 60.0 if variable == "time" else error.temperature)[rows]
    way = direction(error.rate)[rows]
    level(axes)
    for colour, _, sign in DIRECTIONS:
        mine = way == sign
        cloud(axes, x[mine], error.error[rows][mine], colour)


def _name(variable: str) -> str:
    return "time on the hold-out, min" if variable == "time" else "temperature, °C"
