"""Evidence for effects that answer to something beside temperature and time: drawn against that."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import group_of
from hgma_compensation.effects.threshold_step import ThresholdStep
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.report.pictures.canvas import Array, Chart, cloud, instant, label, level, line, thinned
from hgma_compensation.report.pictures.evidence import Evidence
from hgma_compensation.report.words import number, plain_name, unit

THIRDS = ("cool", "rival", "heat")
BINS = 40
CLEAR = 0.2
"""Share of the largest input from which on a ratio to it is clear."""

WINDOW = 6.0
"""°C on either side of a threshold."""


def against_gradient(evidence: Evidence) -> list[Chart]:
    """Return it against T2 − T."""
    return _by_temperature(evidence, evidence.columns[:, 0], "Against the temperature gradient", "T₂ − T, °C")


def against_voltage(evidence: Evidence) -> list[Chart]:
    """Return it against V − V0."""
    nominal = number(float(evidence.effect.parameters()["nominal"]), 4)
    title = "Against the supply voltage"
    return _by_temperature(evidence, evidence.columns[:, 0], title, f"supply voltage less {nominal} V, V")


def against_axis(evidence: Evidence) -> list[Chart]:
    """Return it against the acceleration along the other axis."""
    source = plain_name(str(evidence.effect.parameters()["source"]))
    return [_single(evidence, evidence.columns[:, 0], f"Against {source}", f"{source}, m/s²")]


def against_vibration(evidence: Evidence) -> list[Chart]:
    """Return it against the mean square of the vibration."""
    scale, name = 1.0, f"({unit(evidence.channel)})²"
    if group_of(evidence.channel) == "linear_acceleration":
        scale, name = STANDARD_GRAVITY**2, "g²"
    power = evidence.columns[:, 0] / scale
    return [_single(evidence, power, "Against the vibration level", f"mean square of the vibration, {name}")]


def against_input(evidence: Evidence) -> list[Chart]:
    """Return it against the acceleration that is put in."""
    level_of = evidence.put_in
    return _by_temperature(evidence, level_of, "Against the input level", f"input, {unit(evidence.channel)}")


def scale_factor(evidence: Evidence) -> list[Chart]:
    """Return it over the acceleration that is put in, against the temperature."""
    put_in = evidence.put_in
    rows = np.flatnonzero(np.abs(put_in) > CLEAR * np.abs(put_in).max(initial=0.0))
    if not len(rows):
        return []
    chart = Chart("Error of the scale factor", "What the effect has to carry, over the acceleration that is put in.")
    chart.key("heat", "dot", "positive input")
    chart.key("cool", "dot", "negative input")
    chart.key("fit", "dot", "fitted effect")
    axes, temperature = chart.axes[0], evidence.temperature
    level(axes)
    for colour, sign in (("heat", 1), ("cool", -1)):
        mine = rows[np.sign(put_in[rows]) == sign]
        cloud(axes, temperature[mine], 100.0 * evidence.partial[mine] / put_in[mine], colour, size=3.5)
    cloud(axes, temperature[rows], 100.0 * evidence.contribution[rows] / put_in[rows], "fit", size=1.6, alpha=1.0)
    label(axes, "temperature, °C", "error, %")
    return [chart]


def against_threshold(evidence: Evidence) -> list[Chart]:
    """Return it about the temperature of a step, up and down."""
    if not isinstance(evidence.effect, ThresholdStep):
        return []
    place = evidence.effect.temperature
    away = evidence.temperature - place
    near = np.abs(away) < WINDOW
    crossings = int(np.sum((np.diff(np.sign(away)) != 0) & (np.diff(evidence.blocks.run) == 0)))
    chart = Chart("At the threshold", f"Step at {number(place)} °C, crossed {crossings} times.")
    axes = chart.axes[0]
    instant(axes, 0.0)
    for colour, text, sign in (("heat", "heating", 1), ("cool", "cooling", -1)):
        mine = near & ((evidence.rate > 0.0) == (sign > 0))
        cloud(axes, away[mine], evidence.partial[mine], colour)
        chart.key(colour, "dot", text)
    order = np.flatnonzero(near)[np.argsort(away[near])]
    line(axes, away[order], evidence.contribution[order], "fit")
    chart.key("fit", "line", "fitted effect")
    label(axes, "temperature from the threshold, °C", unit(evidence.channel))
    return [chart]


def _single(evidence: Evidence, x: Array, title: str, name: str) -> Chart:
    chart = Chart(title, "What the effect has to carry, and what is fitted.")
    axes, rows, order = chart.axes[0], thinned(len(x)), np.argsort(x)
    level(axes)
    cloud(axes, x[rows], evidence.partial[rows], "after", alpha=0.6)
    line(axes, x[order], evidence.contribution[order], "fit")
    chart.key("after", "dot", "partial residual")
    chart.key("fit", "line", "fitted effect")
    label(axes, name, unit(evidence.channel))
    return chart


def _by_temperature(evidence: Evidence, x: Array, title: str, name: str) -> list[Chart]:
    """Draw it in thirds of the temperature, with which such an effect may change."""
    chart = Chart(title, "What the effect has to carry, in three ranges of the temperature; lines: fitted.")
    edges = np.linspace(evidence.temperature.min(), evidence.temperature.max(), len(THIRDS) + 1)
    place = np.clip(np.searchsorted(edges, evidence.temperature, side="right") - 1, 0, len(THIRDS) - 1)
    level(chart.axes[0])
    for number_, colour in enumerate(THIRDS):
        rows = np.flatnonzero(place == number_)
        if not len(rows):
            continue
        drawn = rows[thinned(len(rows), 1000)]
        cloud(chart.axes[0], x[drawn], evidence.partial[drawn], colour, alpha=0.6)
        line(chart.axes[0], *_binned(x[rows], evidence.contribution[rows]), colour)
        chart.key(colour, "dot", f"{number(float(edges[number_]), 2)} to {number(float(edges[number_ + 1]), 2)} °C")
    label(chart.axes[0], name, unit(evidence.channel))
    return [chart]


def _binned(x: Array, y: Array) -> tuple[Array, Array]:
    edges = np.linspace(x.min(), x.max() + 1e-12, BINS + 1)
    place: NDArray[np.int64] = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, BINS - 1)
    count = np.bincount(place, minlength=BINS)
    seen = count > 0
    at, mean = (np.bincount(place, values, minlength=BINS)[seen] / count[seen] for values in (x, y))
    return at, mean
