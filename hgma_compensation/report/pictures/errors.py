"""The error of a recording before and after compensation, against time, temperature and its rate."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from hgma_compensation.evaluation.evaluate import ChannelEvaluation
from hgma_compensation.report.pictures.canvas import Chart, cloud, label, level, line
from hgma_compensation.report.pictures.decimate import extremes
from hgma_compensation.report.pictures.ramps import DIRECTIONS, direction, name_directions
from hgma_compensation.report.pictures.svg import COLOURS
from hgma_compensation.report.words import number, unit

Array = NDArray[np.float64]

RATE_WINDOW = 60.0
"""s over which the temperature's rate is read off the means."""

BINS = 48

SECOND, MINUTE, HOUR = 1.0, 60.0, 3600.0


def rates(time: Array, temperature: Array) -> Array:
    """Return the temperature's rate (m,) in °C/s at times (m,) s, over RATE_WINDOW around each."""
    left, right = (np.clip(time + side * 0.5 * RATE_WINDOW, time[0], time[-1]) for side in (-1.0, 1.0))
    rise = np.interp(right, time, temperature) - np.interp(left, time, temperature)
    return np.divide(rise, right - left, out=np.zeros(len(time)), where=right > left)


def error_charts(channel: ChannelEvaluation, most: int) -> list[Chart]:
    """Return before and after on one scale, then what is left on its own; most: points of a series."""
    before, after = channel.raw, channel.compensated
    fell = f"RMS error {number(before.rms_error)} {unit(channel.name)} raw, {number(after.rms_error)} compensated"
    return [
        *(_both(channel, variable, fell, most) for variable in ("time", "temperature")),
        *(_left(channel, variable, most) for variable in ("time", "temperature", "temperature rate")),
        _distribution(channel),
    ]


def _both(channel: ChannelEvaluation, variable: str, fell: str, most: int) -> Chart:
    chart = Chart(f"Error against {variable}", f"Raw and compensated on one scale. {fell}.")
    axes, (x, name) = chart.axes[0], _variable(channel, variable)
    level(axes)
    for error, colour, text in (
        (channel.raw_error, "before", "raw"),
        (channel.compensated_error, "after", "compensated"),
    ):
        rows = extremes(error, most)
        cloud(axes, x[rows], error[rows], colour)
        chart.key(colour, "dot", text)
    label(axes, name, f"error, {unit(channel.name)}")
    return chart


def _left(channel: ChannelEvaluation, variable: str, most: int) -> Chart:
    caption = {
        "time": "On its own scale. The band is the white noise of such a mean, ±2σ.",
        "temperature": "Heating and cooling that run apart are hysteresis or lag: a memory that the model lacks.",
        "temperature rate": "A slope is a delay or a lag of the temperature; a bend at the ends, a rate not learned.",
    }[variable]
    chart = Chart(f"What is left, against {variable}", caption)
    name_directions(chart)
    chart.key("band", "area", "noise")
    axes, (x, name), noise = chart.axes[0], _variable(channel, variable), 2.0 * channel.noise_floor
    axes.axhspan(-noise, noise, color=COLOURS["band"], linewidth=0.0, alpha=0.18)
    level(axes)
    rows = extremes(channel.compensated_error, most)
    way = direction(rates(channel.time, channel.temperature))[rows]
    for colour, _, sign in DIRECTIONS:
        cloud(axes, x[rows][way == sign], channel.compensated_error[rows][way == sign], colour)
    label(axes, name, f"error, {unit(channel.name)}")
    return chart


def _distribution(channel: ChannelEvaluation) -> Chart:
    """Return how often which error is left, and how often noise alone would be as large."""
    chart = Chart(
        "How large what is left is",
        "Share of the means of 5 s by their error. Noise alone would follow the dashed line; wider is drift that is "
        "left, beside zero an offset.",
    )
    axes, error = chart.axes[0], channel.compensated_error
    reach = max(float(np.abs(error).max()), 4.0 * channel.noise_floor, 1e-12)
    edges = np.linspace(-reach, reach, BINS + 1)
    counts, _ = np.histogram(error, edges)
    share = 100.0 * counts / len(error)
    axes.fill_between(edges, np.append(share, 0.0), step="post", color=COLOURS["after"], alpha=0.3, linewidth=0.0)
    _steps(axes, edges, share)
    chart.key("after", "area", "compensated")
    if channel.noise_floor > 0.0:
        fine = np.linspace(-reach, reach, 301)
        width, sigma = edges[1] - edges[0], channel.noise_floor
        density = np.exp(-0.5 * (fine / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi))
        line(axes, fine, 100.0 * width * density, "soak", "--", 1.4)
        chart.key("soak", "dash", "noise alone")
    axes.set_ylim(bottom=0.0)
    axes.locator_params(axis="x", nbins=5)  # small errors have long numbers
    label(axes, f"error, {unit(channel.name)}", "share of the means, %")
    return chart


def _steps(axes: Axes, edges: Array, share: Array) -> None:
    line(axes, np.repeat(edges, 2)[1:-1], np.repeat(share, 2), "after", width=1.2)


def _variable(channel: ChannelEvaluation, variable: str) -> tuple[Array, str]:
    """Return the values (m,) on the x axis, and its name."""
    if variable == "temperature":
        return channel.temperature, "temperature, °C"
    if variable == "temperature rate":
        return 60.0 * rates(channel.time, channel.temperature), "temperature rate, °C/min"
    lasts = float(channel.time[-1] - channel.time[0])
    text, seconds = ("s", SECOND) if lasts < 3 * MINUTE else ("min", MINUTE) if lasts < 5 * HOUR else ("h", HOUR)
    return channel.time / seconds, f"time, {text}"
