"""Draws the paper's Figures 10 to 13: the output before and after each stage, and the Allan deviation of all.

The same oven test, split and rows as benchmarks/paper_table.py. Run: python -m benchmarks.paper_figures FOLDER
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rich.console import Console

from benchmarks.paper_judge import SETTLING, held_out_means, output
from benchmarks.paper_ladder import (
    DRIFT_MODEL,
    DRIFT_MODEL_KF,
    LADDER,
    ORIGINAL,
    RBF,
    RBF_GA,
    RBF_GA_KF,
    Experiment,
    Rows,
)
from benchmarks.paper_oven import OvenTest
from benchmarks.paper_table import argument_parser, experiment_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.allan_confidence import dense_table
from hgma_compensation.evaluation.noise_figures import FILTER_TIMES
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.stamps import NANOSECONDS, seconds_between

Array = NDArray[np.float64]
FOLDER = Path("paper_output")
COLOURS = {
    ORIGINAL: "#444444",
    RBF: "#b5482a",
    RBF_GA: "#d99a2b",
    RBF_GA_KF: "#5a8f4e",
    DRIFT_MODEL: "#8a6fae",
    DRIFT_MODEL_KF: "#1f6f8b",
}
OUTPUTS = {
    "figure_10_original": (ORIGINAL,),
    "figure_11_rbf": (RBF,),
    "figure_12_rbf_ga": (RBF_GA, DRIFT_MODEL),
    "figure_13_rbf_ga_kf": (RBF_GA_KF, DRIFT_MODEL_KF),
}
"""File names without ending, and the rows in each."""


@dataclass(frozen=True)
class HeldOut:
    """Means over 5 s of the held-out cycle: minutes (m,) from its beginning, °C (m,), and g (m,) by row."""

    minutes: Array
    temperature: Array
    error_g: dict[str, Array]


def held_out(test: OvenTest, rows: Rows, names: Sequence[str]) -> HeldOut:
    """Return the held-out cycle of the rows."""
    stamps = test.clean.temperature.stamps
    temperature = np.interp(test.whole.stamps, stamps, test.clean.temperature.values)
    time = held_out_means(test, seconds_between(test.whole.stamps, test.whole.start))
    errors = {}
    for name in names:
        values = output(test, test.whole, rows.calibrations.get(name))
        errors[name] = (held_out_means(test, values) - test.true_value) / STANDARD_GRAVITY
    return HeldOut((time - test.split) / 60.0, held_out_means(test, temperature), errors)


def output_figure(data: HeldOut, names: Sequence[str]) -> Figure:
    """Return the error of the rows against time and against temperature, side by side."""
    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    for name in names:
        error = data.error_g[name]
        label = f"{name}: span {np.ptp(error):.4g} g, RMS {np.sqrt(np.mean(error**2)):.4g} g"
        left.plot(data.minutes, error, color=COLOURS[name], linewidth=1.0, label=label)
        right.plot(data.temperature, error, color=COLOURS[name], linewidth=0.8)
    left.set(xlabel="time in the held-out cycle, min", ylabel="output less the true value, g\n(means over 5 s)")
    right.set(xlabel="temperature, °C")
    for axes in (left, right):
        axes.grid(color="0.9")
        axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
    figure.legend(loc="outside upper center", ncols=1, frameon=False)
    return figure


def allan_figure(test: OvenTest, rows: Rows, names: Sequence[str]) -> Figure:
    """Return the Allan deviations at rest, the first and the last stage with their 95 % intervals as bands."""
    figure = Figure(figsize=(8.0, 5.6), layout="constrained")
    axes = figure.subplots()
    settled = seconds_between(test.still.stamps, test.still.start) >= SETTLING
    interval = float(np.median(np.diff(test.still.stamps))) / NANOSECONDS
    for name in names:
        values = output(test, test.still, rows.calibrations.get(name))[settled] / STANDARD_GRAVITY
        table = dense_table(values, interval)
        style = "--" if name in (RBF_GA_KF, DRIFT_MODEL_KF) else "-"
        axes.loglog(table.taus, table.deviations, style, color=COLOURS[name], linewidth=1.5, label=name)
        if name in (ORIGINAL, DRIFT_MODEL_KF):
            axes.fill_between(table.taus, table.lower, table.upper, color=COLOURS[name], alpha=0.12, linewidth=0.0)
    mark_filter(axes, rows)
    axes.set(xlabel="averaging time τ, s", ylabel="Allan deviation at rest, g")
    axes.grid(which="major", color="0.88")
    figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return figure


def mark_filter(axes: Axes, rows: Rows) -> None:
    """Shade the averaging times at which a curve with a Kalman stage shows the filter and not the sensor."""
    if DRIFT_MODEL_KF in rows.stages:
        end = FILTER_TIMES * rows.stages[DRIFT_MODEL_KF].time_constant
        axes.axvline(end, color="0.5", linewidth=0.8, linestyle=":")
        axes.annotate(
            "dashed curves show\nthe filter up to here",
            (end, 0.98),
            xycoords=("data", "axes fraction"),
            xytext=(-6, 0),
            textcoords="offset points",
            ha="right",
            va="top",
            fontsize="small",
            color="0.35",
        )


def draw(experiment: Experiment, folder: Path, console: Console) -> list[Path]:
    """Write all figures as PNG and return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    with console.status("simulating") as status:
        test, rows = experiment.run(1, status.update)
        data = held_out(test, rows, tuple(COLOURS))
        figures = {name: output_figure(data, shown) for name, shown in OUTPUTS.items()}
        figures["allan_deviation"] = allan_figure(test, rows, (*LADDER[:-1], DRIFT_MODEL, DRIFT_MODEL_KF))
        paths = [folder / f"{name}.png" for name in figures]
        for path, figure in zip(paths, figures.values(), strict=True):
            figure.savefig(path, dpi=110)
    return paths


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the figures and print where they are."""
    parser = argument_parser(__doc__ or "")
    parser.add_argument("folder", type=Path, nargs="?", default=FOLDER, help="where the PNG files go")
    given = parser.parse_args(arguments)
    try:
        paths = draw(experiment_of(given), given.folder, Console(stderr=True))
    except RefusedError as refusal:
        print(refusal, file=sys.stderr)
        return 2
    for path in paths:
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
