"""Prints the error of every method on the measured chamber recording, judged on the cooling held out.

Fitted on the first cooling and the heating (t < 3128 s), with features T, Ṫ and T·ΔT as the node
computes them, running causally from the first row to the last; RMS of means over 10 rows of the last
cooling. The model is chosen by cross-validation inside the first two branches; the last is used once,
for this table. Run: make chamber-table
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from hgma_compensation.channels import AXES
from hgma_compensation.measured_data import VARIABLE, chamber_table
from hgma_compensation.recording.csv_table import Columns, read_table
from hgma_compensation.recording.recording import Recording
from hgma_compensation.stamps import seconds_between
from hgma_compensation.temperature.features import FeatureSettings, Product, read_features
from hgma_compensation.temperature.track import TemperatureTrack
from hgma_compensation.training.blocks import Blocks, block_means, group_means, noise_of_means
from hgma_compensation.training.methods import Method
from hgma_compensation.training.thermistor import feature_settings
from hgma_compensation.training.train import TrainingOptions, train_on_blocks

CHANNELS = tuple(f"linear_acceleration.{axis}" for axis in AXES)
SPLIT = 3128.0
ROWS = 10
OUTLIERS = 5
"""Rows at the start of the file that are a start-up outlier, as its description says."""


def load(table: Path, start: float | None = None, end: float | None = None) -> Recording:
    """Return the chamber recording, or the part of it from start to before end (s)."""
    columns = {f"linear_acceleration.{axis}": f"acc_{axis}_mps2" for axis in AXES}
    return read_table(table, Columns("t_s", "temp_C", columns, start=start, end=end, skip_rows=OUTLIERS))


def rows_of_ten(recording: Recording, track_: TemperatureTrack, settings: FeatureSettings, start: float) -> Blocks:
    """Return means over ten rows of the samples from start (s) on."""
    keep = recording.stamps >= round(start * 1e9)
    features = read_features(track_, settings, recording.stamps[keep])
    index = np.arange(keep.sum()) // ROWS
    full = index < keep.sum() // ROWS
    time = seconds_between(recording.stamps[keep], 0)
    columns = np.column_stack([time, features.values, recording.values[keep, :3]])
    means = group_means(index[full], columns[full])
    return Blocks(means[:, 0], np.zeros(len(means), dtype=np.int64), means[:, 1:4], means[:, 4:])


def main() -> int:
    """Print the table; with --json also write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--seeds", type=int, default=5, help="how many seeds (1, 2, ...) the random methods are run with"
    )
    parser.add_argument("--json", type=Path, help="file for the figures")
    arguments = parser.parse_args()
    table = chamber_table()
    if table is None:
        print(f"no measured data: set {VARIABLE} to the folder that holds chamber_imu/", file=sys.stderr)
        return 2
    whole, training = load(table), load(table, end=SPLIT)
    settings = feature_settings([training], delay=60.0, product=Product.DELAY, reference_temperature=25.0)
    track_ = TemperatureTrack(settings.noise)
    track_.extend(whole.temperature.stamps, whole.temperature.values)
    held_out = rows_of_ten(whole, track_, settings, SPLIT)
    blocks = block_means([training], CHANNELS, settings, 5.0)
    runs = [(method, seed) for method in Method for seed in seeds_of(method, arguments.seeds)]
    errors: dict[Method, list[NDArray[np.float64]]] = {method: [] for method in Method}
    for method, seed in track(runs, description="training", console=Console(stderr=True), transient=True):
        calibration = train_on_blocks(
            blocks, [training], CHANNELS, settings, 5.0, TrainingOptions(method=method, seed=seed)
        )
        inside = calibration.calibrated_range.clamp(held_out.features)
        predicted = np.stack([c.drift.evaluate(inside) + c.reference for c in calibration.channels], axis=1)
        errors[method].append(rms(held_out.values - predicted))
    mean_only = rms(held_out.values - blocks.values.mean(axis=0))
    noise = np.array([noise_of_means(column) for column in held_out.values.T])
    report(errors, mean_only, noise)
    if arguments.json:
        figures = {method.value: np.array(rows).tolist() for method, rows in errors.items()}
        arguments.json.write_text(json.dumps({"rms": figures, "noise": noise.tolist()}, indent=1) + "\n")
    return 0


def seeds_of(method: Method, count: int) -> Sequence[int]:
    """Return the seeds to run a method with; least squares has no use for more than one."""
    return range(1, count + 1) if method in (Method.RBF_GA, Method.RBF) else (1,)


def rms(error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the root of the mean square of each column."""
    return np.asarray(np.sqrt(np.mean(error**2, axis=0)))


def report(
    errors: dict[Method, list[NDArray[np.float64]]],
    mean_only: NDArray[np.float64],
    noise: NDArray[np.float64],
) -> None:
    """Print the table: median, and least and greatest over the seeds."""
    table = Table(
        title="RMS error on the last cooling, m/s², means over 10 rows; median (least to greatest) over seeds"
    )
    for heading in ("model", "seeds", "x", "y", "z"):
        table.add_column(heading, justify="left" if heading == "model" else "right")
    table.add_row("mean only", "", *(f"{value:.4f}" for value in mean_only))
    names = {
        Method.POLYNOMIAL: "cubic in T (PX4, ArduPilot)",
        Method.POLYNOMIAL_RATE: "cubic with Ṫ and T·Ṫ",
        Method.RBF: "RBF network, Eq. (6)",
        Method.RBF_GA: "RBF network, genetic search",
    }
    for method, name in names.items():
        rows = np.array(errors[method])
        cells = [f"{m:.4f}" for m in np.median(rows, axis=0)]
        if len(rows) > 1:
            cells = [f"{c} ({a:.4f} to {b:.4f})" for c, a, b in zip(cells, rows.min(0), rows.max(0), strict=True)]
        table.add_row(name, str(len(rows)), *cells)
    table.add_row("noise of such a mean", "", *(f"{value:.4f}" for value in noise))
    Console(width=130).print(table)


if __name__ == "__main__":
    sys.exit(main())
