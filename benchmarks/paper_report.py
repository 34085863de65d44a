"""The tables that benchmarks/paper_table.py prints."""

from typing import Any

from rich.table import Table

from benchmarks.paper_ladder import (
    ALONE,
    BASELINES,
    DRIFT_MODEL,
    DRIFT_MODEL_BIAS,
    DRIFT_MODEL_KF,
    LADDER,
    ORIGINAL,
    RBF_GA_KF,
)
from benchmarks.spread import median, text
from hgma_compensation.evaluation.paper_figures_of_merit import PAPER

ROWS = LADDER + ALONE + BASELINES
PAPER_KEYS = ("acceleration_random_walking", "bias_stability", "span_g")
SHOWN_TAUS = ("0.1", "1", "10", "100", "1000", "3000", "10000")
SHOWN_ROWS = (ORIGINAL, DRIFT_MODEL, DRIFT_MODEL_BIAS, RBF_GA_KF, DRIFT_MODEL_KF)
SHOCK_KEYS = ("peak", "width", "velocity_change", "velocity_of_record")


def table_3(row: dict[str, Any]) -> dict[str, float]:
    """Return the three figures of the paper's Table 3."""
    return {**row["paper"], "span_g": row["drift"]["span_g"]}


def paper_report(figures: dict[str, Any]) -> Table:
    """Return the table in the paper's terms."""
    table = Table(title="Table 3 in the paper's terms (N: acceleration random walking, B: bias stability)")
    headings = ("row", "N, g/h/√Hz", "B, g/h", "span, g", "N ÷", "B ÷", "span ÷")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "row" else "right")
    for name in LADDER + ALONE:
        row = figures["rows"][name]
        cells = [text(table_3(row), key, form=".4g") for key in PAPER_KEYS]
        ratios = [text(row["ratio"], key, form=".3g") for key in PAPER_KEYS]
        table.add_row(name, *cells, *ratios, end_section=name in (LADDER[-1], ALONE[-1]))
    for name, numbers in PAPER.items():
        ratios = [f"{a / b:.3g}" for a, b in zip(PAPER["original"], numbers, strict=True)]
        table.add_row(f"paper, {name}", *(f"{number:g}" for number in numbers), *ratios)
    return table


def error_report(figures: dict[str, Any]) -> Table:
    """Return the errors on the held-out cycle, over means of 5 s."""
    table = Table(title="Held-out cycle, means over 5 s")
    for heading in ("row", "RMS error, g", "error / floor", "span, g"):
        table.add_column(heading, justify="left" if heading == "row" else "right")
    for name in ROWS:
        drift = figures["rows"][name]["drift"]
        table.add_row(name, *(text(drift, key) for key in ("rms_error_g", "over_floor", "span_g")))
    table.add_section()
    table.add_row("accelerometer's noise alone", text(figures["floor_g"], "accelerometer"))
    table.add_row("floor: with the thermistor's noise", text(figures["floor_g"], "with_thermistor"))
    return table


def noise_report(figures: dict[str, Any]) -> Table:
    """Return the Allan deviations at rest at fixed times, and N and B where they are defined; medians."""
    table = Table(title="At rest: Allan deviation in g [95 % interval]; N in g/√Hz and B in g where they are defined")
    table.add_column("")
    for name in SHOWN_ROWS:
        table.add_column(name, justify="right")
    honest = [figures["rows"][name]["honest"] for name in SHOWN_ROWS]
    for tau in SHOWN_TAUS:
        table.add_row(f"τ = {tau} s", *(interval_text(one["adev"].get(tau)) for one in honest))
    table.add_section()
    for label, key in (("N", "velocity_random_walk"), ("B", "bias_instability")):
        table.add_row(label, *(figure_text(one[key], len(figures["seeds"])) for one in honest))
    for label, key in (("stage's time constant, s", "filter_time_constant_s"), ("bandwidth, Hz", "bandwidth_hz")):
        table.add_row(label, *(number(median(one, key)) for one in honest))
    return table


def shock_report(figures: dict[str, Any]) -> Table:
    """Return what becomes of shocks, medians of the relative errors."""
    table = Table(title="Shock errors at 10 kHz, %: peak / width / velocity change / velocity of the whole record")
    kinds = {"half_sine_quiet": "half-sine, quiet sensor", "half_sine": "half-sine", "drop_tower_worst": "drop tower"}
    for heading in ("row", *kinds.values()):
        table.add_column(heading, justify="left" if heading == "row" else "right")
    for name in LADDER[1:] + ALONE:
        shock = figures["rows"][name]["shock"]
        cells = [" / ".join(percent(median(shock, kind, key)) for key in SHOCK_KEYS) for kind in kinds]
        table.add_row(name, *cells)
    return table


def interval_text(point: dict[str, Any] | None, key: str = "adev_g") -> str:
    """Return the median of a value and of its 95 % interval, nothing where there is none."""
    if not point or point[key] is None:
        return ""
    value, low, high = (float(point[name]["median"]) for name in (key, "lower_g", "upper_g"))
    return f"{value:.3g} [{low:.3g}, {high:.3g}]"


def figure_text(figure: dict[str, Any] | None, seeds: int) -> str:
    """Return N or B with its interval, that it is not defined, or in how many of the seeds it is."""
    if not figure:
        return "not defined"
    some = figure["value_g"].get("seeds")
    return interval_text(figure, "value_g") + (f" in {some} of {seeds} seeds" if some else "")


def percent(value: float | None) -> str:
    """Return a relative error in percent, a dash where there is none."""
    return "-" if value is None else f"{100.0 * value:.2f}".replace("-0.00", "0.00")


def number(value: float | None) -> str:
    """Return a number, a dash where there is none."""
    return "-" if value is None else f"{value:.3g}"
