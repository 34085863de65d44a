"""Allan deviation of a recording, raw and compensated, with the figures that are read off it."""

import numpy as np

from hgma_compensation.evaluation.allan import FLICKER_FLOOR, AllanCurve
from hgma_compensation.evaluation.evaluate import ChannelEvaluation
from hgma_compensation.report.pictures.canvas import Chart, label, line, logarithmic
from hgma_compensation.report.pictures.svg import COLOURS
from hgma_compensation.report.words import number, unit

CAPTION = (
    "Of the samples themselves. Dashed: white noise N/√τ of the raw samples, the floor that no drift model goes below. "
    "Dots: where N and B are read. A bump at the time of a temperature cycle is drift; real motion counts too."
)


def allan_chart(channel: ChannelEvaluation, curves: tuple[AllanCurve, AllanCurve]) -> Chart:
    """Return the deviation of the raw and of the compensated samples (curves in this order)."""
    chart = Chart("Allan deviation", CAPTION, height=3.2)
    axes = chart.axes[0]
    for curve, measures, colour, text in zip(
        curves, (channel.raw, channel.compensated), ("before", "after"), ("raw", "compensated"), strict=True
    ):
        shown = curve.deviations > 0.0
        if not shown.any():
            continue
        line(axes, curve.taus[shown], curve.deviations[shown], colour)
        chart.key(colour, "line", text)
        if measures.velocity_random_walk is None or measures.bias_instability is None:
            continue
        least = int(np.argmin(np.where(shown, curve.deviations, np.inf)))
        marks = [
            (float(curve.taus[0]), measures.velocity_random_walk / float(np.sqrt(curve.taus[0])), "N"),
            (float(curve.taus[least]), FLICKER_FLOOR * measures.bias_instability, "B"),
        ]
        above = text == "raw"
        for tau, deviation, name in marks:
            axes.plot([tau], [deviation], marker="o", markersize=4.5, color=COLOURS[colour], linestyle="none")
            axes.annotate(
                name,
                (tau, deviation),
                xytext=(4, 5 if above else -11),
                textcoords="offset points",
                color=COLOURS["ink"],
                fontsize="small",
            )
    floor = channel.raw.velocity_random_walk
    if floor:
        taus = curves[0].taus
        line(axes, taus, floor / np.sqrt(taus), "soak", "--", 1.2)
        chart.key("soak", "dash", f"N/√τ, N = {number(floor)} {unit(channel.name)}/√Hz")
    if chart.keys:
        logarithmic(axes)
    label(axes, "averaging time τ, s", f"Allan deviation, {unit(channel.name)}")
    return chart
