"""The figures of one row: on the held-out cycle, on the still record, and under shocks."""

from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.paper_oven import OvenTest
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.evaluation.evaluate import MEAN_SECONDS
from hgma_compensation.evaluation.measured_shocks import measured_shocks
from hgma_compensation.evaluation.noise_figures import Figure, NoiseFigures, Stage, noise_figures
from hgma_compensation.evaluation.noise_floor import NoiseFloor, noise_floor
from hgma_compensation.evaluation.paper_figures_of_merit import paper_figures
from hgma_compensation.evaluation.shock import StillSensor, shock_errors
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.recording.recording import Recording
from hgma_compensation.stamps import NANOSECONDS, seconds_between
from hgma_compensation.training.blocks import group_means

Array = NDArray[np.float64]
Figures = dict[str, Any]
SHOCK_RATE = 10_000.0
SETTLING = 600.0
"""s at the beginning of the still record that are not read: trend filter and Kalman stage start there."""


def judge_drift(test: OvenTest, calibration: Calibration | None) -> Figures:
    """Return RMS and span (g) of the error on the held-out cycle, None for the original output."""
    error = held_out_means(test, output(test, test.whole, calibration)) - test.true_value
    rms, span = float(np.sqrt(np.mean(error**2))), float(np.ptp(error))
    return {"rms_error_g": rms / STANDARD_GRAVITY, "span_g": span / STANDARD_GRAVITY}


def judge_noise(test: OvenTest, calibration: Calibration | None, stage: Stage | None) -> Figures:
    """Return the noise at rest, in the paper's terms and honestly."""
    settled = seconds_between(test.still.stamps, test.still.start) >= SETTLING
    values = output(test, test.still, calibration)[settled]
    interval = float(np.median(np.diff(test.still.stamps))) / NANOSECONDS
    return {
        "paper": asdict(paper_figures(values, interval)),
        "honest": honest(noise_figures(values, interval, stage), stage),
    }


def output(test: OvenTest, recording: Recording, calibration: Calibration | None) -> Array:
    """Return the samples (n,) of the channel, compensated where there is a calibration."""
    if calibration is None:
        return test.column(recording)
    return compensate_recording(recording, calibration).values[:, 0]


def held_out_means(test: OvenTest, values: Array) -> Array:
    """Return the means over MEAN_SECONDS of values (n,) of the whole recording inside the held-out cycle."""
    time = seconds_between(test.whole.stamps, test.whole.start)
    rows = time >= test.split
    return group_means(np.floor(time[rows] / MEAN_SECONDS).astype(np.int64), values[rows, None])[:, 0]


def floors(test: OvenTest, calibration: Calibration) -> NoiseFloor:
    """Return what a perfect model with the calibration's causal temperature would leave on the held-out cycle.

    Such a model still takes the mean of the flicker noise over the training cycles for drift.
    """
    rows = seconds_between(test.whole.stamps, test.whole.start) >= test.split
    stamps, clean = test.whole.stamps, test.column(test.clean)
    true = np.interp(stamps, test.clean.temperature.stamps, test.clean.temperature.values)
    estimated = compensate_recording(test.whole, calibration).features[:, 0]
    noise = test.column(test.whole) - clean
    noise = noise - noise[~rows].mean()
    return noise_floor(stamps[rows], noise[rows], clean[rows], (true[rows], estimated[rows]), MEAN_SECONDS)


def honest(figures: NoiseFigures, stage: Stage | None) -> Figures:
    """Return the figures in g: deviations by τ with their intervals, N and B or None, the filter's bandwidth."""
    table = figures.table
    to_g = 1.0 / STANDARD_GRAVITY
    adev = {
        f"{tau:g}": {"adev_g": dev * to_g, "lower_g": low * to_g, "upper_g": high * to_g}
        for tau, dev, low, high in zip(table.taus, table.deviations, table.lower, table.upper, strict=True)
    }
    return {
        "adev": adev,
        "velocity_random_walk": in_g(figures.velocity_random_walk),
        "bias_instability": in_g(figures.bias_instability),
        "filter_time_constant_s": None if stage is None else stage.time_constant,
        "bandwidth_hz": None if stage is None else stage.bandwidth,
    }


def in_g(figure: Figure) -> Figures | None:
    """Return a figure with its interval in g (N: g/√Hz) and the τ it was read at, None where it is not defined."""
    if figure.value is None or figure.lower is None or figure.upper is None:
        return None
    values = {"value": figure.value, "lower": figure.lower, "upper": figure.upper}
    return {**{f"{name}_g": value / STANDARD_GRAVITY for name, value in values.items()}, "tau_s": figure.tau}


def shocks(calibration: Calibration, white_noise: float) -> Figures:
    """Return the errors of the 1 ms 10 000 g half-sine, and the worst over the measured shocks where there are any.

    half_sine_quiet: on a sensor without noise; the others under the noise of this one.
    """
    noisy = StillSensor(white_noise=white_noise)
    figures: Figures = {
        "half_sine_quiet": asdict(shock_errors(calibration, SHOCK_RATE)),
        "half_sine": asdict(shock_errors(calibration, SHOCK_RATE, sensor=noisy)),
    }
    measured = [asdict(shock_errors(calibration, SHOCK_RATE, s, noisy)) for s in measured_shocks().values()]
    if measured:
        figures["drop_tower_worst"] = {key: max((m[key] for m in measured), key=magnitude) for key in measured[0]}
    return figures


def magnitude(error: float | None) -> float:
    """Return how bad an error is; one that cannot be told is the worst."""
    return np.inf if error is None else abs(error)
