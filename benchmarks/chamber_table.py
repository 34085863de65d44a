"""Prints the error of every method on the measured chamber recording, judged on the cooling held out.

Fitted on the first cooling and the heating (t < 3128 s), with features T, Ṫ and T·ΔT as the node
computes them, running causally from the first row to the last; RMS of means over 10 rows of the last
cooling. The models are chosen by cross-validation inside the first two branches. Run: make chamber-table
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from hgma_compensation.channels import AXES
from hgma_compensation.measured_data import CHAMBER_OUTLIERS, CHAMBER_SPLIT, VARIABLE, chamber_table
from hgma_compensation.recording.csv_table import Columns, read_table
from hgma_compensation.recording.recording import Recording
from hgma_compensation.temperature.features import FeatureSettings, Product, read_features
from hgma_compensation.temperature.track import TemperatureTrack
from hgma_compensation.training.blocks import Blocks, block_means, group_means, noise_of_means
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.methods import Method
from hgma_compensation.training.thermistor import feature_settings
from hgma_compensation.training.train import TrainingOptions, train_on_blocks

CHANNELS = tuple(f"linear_acceleration.{axis}" for axis in AXES)
ROWS = 10
BLOCK = 5.0
DEFAULTS = GeneticSettings()
VARIANTS = {
    "defaults": DEFAULTS,
    "6 centres": replace(DEFAULTS, centres=6),
    "12 centres": replace(DEFAULTS, centres=12),
    "100 generations": replace(DEFAULTS, generations=100),
    "400 generations": replace(DEFAULTS, generations=400),
    "widths of the rate inputs from 1": replace(DEFAULTS, widths=(DEFAULTS.widths[0], (1.0, 20.0), (1.0, 20.0))),
    "widths of the rate inputs from 3": replace(DEFAULTS, widths=(DEFAULTS.widths[0], (3.0, 20.0), (3.0, 20.0))),
}
"""Settings of the search that --sensitivity compares."""

NAMES = {
    Method.POLYNOMIAL: "cubic in T (PX4, ArduPilot)",
    Method.POLYNOMIAL_RATE: "cubic with Ṫ and T·Ṫ",
    Method.RBF: "RBF network, Eq. (6)",
    Method.RBF_GA: "RBF network, genetic search",
}


@dataclass(frozen=True)
class Figures:
    """RMS on the last cooling, m/s², columns x, y, z: of each method a row per seed; of the mean; of noise."""

    methods: dict[Method, NDArray[np.float64]]
    mean_only: NDArray[np.float64]
    noise: NDArray[np.float64]


def measure(
    path: Path, seeds: Sequence[int], methods: Sequence[Method] = tuple(NAMES), genetic: GeneticSettings = DEFAULTS
) -> Figures:
    """Train every method with every seed and judge it on the last cooling."""
    whole, training = load(path), load(path, end=CHAMBER_SPLIT)
    settings = feature_settings([training], delay=60.0, product=Product.DELAY, reference_temperature=25.0)
    held_out = last_cooling(whole, settings)
    blocks = block_means([training], CHANNELS, settings, BLOCK)
    runs = [(method, seed) for method in methods for seed in (seeds if is_random(method) else seeds[:1])]
    errors: dict[Method, list[NDArray[np.float64]]] = {method: [] for method in methods}
    for method, seed in track(runs, description="training", console=Console(stderr=True), transient=True):
        options = TrainingOptions(method=method, seed=seed, genetic=genetic)
        calibration = train_on_blocks(blocks, [training], CHANNELS, settings, BLOCK, options)
        inside = calibration.calibrated_range.clamp(held_out.features)
        predicted = np.stack([c.drift.evaluate(inside) + c.reference for c in calibration.channels], axis=1)
        errors[method].append(rms(held_out.values - predicted))
    return Figures(
        methods={method: np.array(rows) for method, rows in errors.items()},
        mean_only=rms(held_out.values - blocks.values.mean(axis=0)),
        noise=np.array([noise_of_means(column) for column in held_out.values.T]),
    )


def load(path: Path, end: float | None = None) -> Recording:
    """Return the chamber recording, or its part before end (s)."""
    columns = {f"linear_acceleration.{axis}": f"acc_{axis}_mps2" for axis in AXES}
    return read_table(path, Columns("t_s", "temp_C", columns, end=end, skip_rows=CHAMBER_OUTLIERS))


def last_cooling(whole: Recording, settings: FeatureSettings) -> Blocks:
    """Return means over ten rows of the last cooling, with the features that the history before it gives."""
    history = TemperatureTrack(settings.noise)
    history.extend(whole.temperature.stamps, whole.temperature.values)
    keep = whole.stamps >= round(CHAMBER_SPLIT * 1e9)
    features = read_features(history, settings, whole.stamps[keep])
    rows = np.column_stack([whole.stamps[keep] * 1e-9, features.values, whole.values[keep, :3]])
    full = rows[: len(rows) // ROWS * ROWS]
    means = group_means(np.arange(len(full)) // ROWS, full)
    return Blocks(means[:, 0], np.zeros(len(means), dtype=np.int64), means[:, 1:4], means[:, 4:])


def is_random(method: Method) -> bool:
    """Return whether the method depends on a seed; least squares does not."""
    return method in (Method.RBF_GA, Method.RBF)


def rms(error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the root of the mean square of each column."""
    return np.asarray(np.sqrt(np.mean(error**2, axis=0)))


def report(figures: Figures) -> Table:
    """Return the table: median, and least to greatest over the seeds."""
    table = Table(
        title="RMS error on the last cooling, m/s², means over 10 rows; median (least to greatest) over seeds"
    )
    for heading in ("model", "seeds", "x", "y", "z"):
        table.add_column(heading, justify="left" if heading == "model" else "right")
    table.add_row("mean only", "", *(f"{value:.4f}" for value in figures.mean_only))
    for method, rows in figures.methods.items():
        cells = [f"{median:.4f}" for median in np.median(rows, axis=0)]
        if len(rows) > 1:
            cells = [f"{c} ({a:.4f} to {b:.4f})" for c, a, b in zip(cells, rows.min(0), rows.max(0), strict=True)]
        table.add_row(NAMES[method], str(len(rows)), *cells)
    table.add_row("noise of such a mean", "", *(f"{value:.4f}" for value in figures.noise))
    return table


def sensitivity(path: Path, seeds: Sequence[int]) -> Table:
    """Return the errors under settings of the search beside the defaults."""
    table = Table(title="RBF network, genetic search: RMS error, m/s², median over seeds; settings beside the defaults")
    for heading in ("setting", "x", "y", "z"):
        table.add_column(heading, justify="left" if heading == "setting" else "right")
    for name, settings in VARIANTS.items():
        rows = measure(path, seeds, [Method.RBF_GA], settings).methods[Method.RBF_GA]
        table.add_row(name, *(f"{median:.4f}" for median in np.median(rows, axis=0)))
    return table


def main() -> int:
    """Print the table; with --json also write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5, help="run the random methods with seeds 1 to this")
    parser.add_argument("--json", type=Path, help="file for the figures")
    parser.add_argument("--sensitivity", action="store_true", help="instead vary the settings of the search")
    arguments = parser.parse_args()
    path = chamber_table()
    if path is None:
        print(f"no measured data: set {VARIABLE} to the folder that holds chamber_imu/", file=sys.stderr)
        return 2
    if arguments.sensitivity:
        Console(width=130).print(sensitivity(path, range(1, arguments.seeds + 1)))
        return 0
    figures = measure(path, range(1, arguments.seeds + 1))
    Console(width=130).print(report(figures))
    if arguments.json:
        rows = {method.value: values.tolist() for method, values in figures.methods.items()}
        arguments.json.write_text(json.dumps({"rms": rows, "noise": figures.noise.tolist()}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
