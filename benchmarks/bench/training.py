"""Training on a simulated recording of 12 h against a Gaussian process and kernel ridge regression."""

from collections.abc import Callable
from dataclasses import asdict

from benchmarks.bench.given import Given
from benchmarks.bench.row import Result, Row, Target
from benchmarks.training_speed import HOURS, TrainingSpeed
from benchmarks.training_speed import measure as measure_once

GROUP = "training"
MOST_REPETITIONS = 3
"""At most: a Gaussian process on all means takes minutes."""

PROCESS, RIDGE = "Gaussian process on the same means", "kernel ridge on the same means"


def measure(given: Given) -> Result:
    """Return the rows of training; each repetition has a sensor, hence a recording, of its own."""
    runs: list[TrainingSpeed] = []
    repetitions = min(given.repetitions, MOST_REPETITIONS)
    for seed in range(1, repetitions + 1):
        runs.append(measure_once(seed, points=None))
        given.say(f"training {seed}/{repetitions}: {asdict(runs[-1])}")

    def row(
        name: str, unit: str, rival: str, figure: Callable[[TrainingSpeed], tuple[float, float]], limit: float
    ) -> Row:
        ours, rivals = zip(*(figure(run) for run in runs), strict=True)
        return Row(GROUP, name, unit, rival, ours, rivals, Target(limit) if limit else None)

    length = f"{HOURS:g} h, one channel"
    rows = (
        row(f"fit, {length}", "s", PROCESS, lambda r: (r.network_seconds, r.gaussian_process_seconds), 1.0),
        row("error held out", "m/s²", PROCESS, lambda r: (r.network_error, r.gaussian_process_error), 1.0),
        row(f"fit, {length}", "s", RIDGE, lambda r: (r.network_seconds, r.kernel_ridge_seconds), 0.0),
        row("error held out", "m/s²", RIDGE, lambda r: (r.network_error, r.kernel_ridge_error), 0.0),
    )
    points = {run.gaussian_process_points for run in runs}
    return Result(rows, {"runs": [asdict(run) for run in runs], "gaussian_process_points": sorted(points)})
