"""What the fit leaves in the recordings that were learned from."""

from hgma_compensation.diagnosis.problem import State
from hgma_compensation.report.pictures.canvas import Chart, cloud, instant, label, level, thinned
from hgma_compensation.report.pictures.evidence import View
from hgma_compensation.report.pictures.ramps import DIRECTIONS, name_directions
from hgma_compensation.report.words import unit


def left_charts(state: State, channel: str) -> list[Chart]:
    """Return the residual of a state over the recorded time and against the temperature."""
    _, residual = state.fit()
    view = View(channel, state)
    charts = []
    for title, name, x in (
        ("Residual over the recordings", "recorded time, h (pauses cut out)", view.recorded_hours),
        ("Residual against temperature", "temperature, °C", view.temperature),
    ):
        chart = Chart(title, "Of the whole fit, drift model and effects refitted.")
        name_directions(chart)
        level(chart.axes[0])
        rows = thinned(len(residual))
        for colour, _, sign in DIRECTIONS:
            mine = rows[view.direction[rows] == sign]
            cloud(chart.axes[0], x[mine], residual[mine], colour)
        label(chart.axes[0], name, f"residual, {unit(channel)}")
        charts.append(chart)
    for rows in view.runs[1:]:
        instant(charts[0].axes[0], float(view.recorded_hours[rows[0]]))
    return charts
