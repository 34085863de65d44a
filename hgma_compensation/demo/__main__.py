"""Trains on part of a recording, plays the rest to the real node, and prints the error before and after."""

import os
import shutil
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hgma_compensation import topics
from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.channels import AXES, columns_of
from hgma_compensation.cli.evaluate import table
from hgma_compensation.cli.tables import console
from hgma_compensation.demo.live_run import run_live
from hgma_compensation.demo.processes import run_hgma
from hgma_compensation.errors import RefusedError
from hgma_compensation.evaluation.evaluate import Evaluation, compare
from hgma_compensation.evaluation.plots import plot_evaluation
from hgma_compensation.measured_data import CHAMBER_OUTLIERS, CHAMBER_SPLIT, VARIABLE, chamber_table
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.training.reference import Reference

OUTPUT = Path("demo_output")
OVEN_BAG = Path("bags/oven_test")
OVEN_SPLIT = 17_100.0
"""s: end of the second cycle of params/oven_test.yaml; the third has a ramp rate of its own."""

WALL_TIME = 40.0
"""s that the playing of the held-out part takes."""


@dataclass(frozen=True)
class Case:
    """A demonstration: bags to train on and to play, in a folder of its own."""

    name: str
    folder: Path
    training: Path
    held_out: Path


def cases() -> Iterator[Case]:
    """Prepare and yield the demonstrations that this machine has data for."""
    if OVEN_BAG.exists():
        folder = _fresh(OUTPUT / "oven")
        recording = read_recording(OVEN_BAG)
        write_recording(recording.cut(None, OVEN_SPLIT), folder / "training")
        write_recording(recording.cut(OVEN_SPLIT, None), folder / "held_out")
        yield Case(
            "simulated high-g accelerometer, oven cycle held out",
            folder,
            folder / "training",
            folder / "held_out",
        )
    chamber = chamber_table()
    if chamber is None:
        print(f"no measured data here (set {VARIABLE} to its folder): the thermal chamber is left out")
        return
    folder = _fresh(OUTPUT / "chamber")
    columns = [word for axis in AXES for word in (f"--linear-acceleration-{axis}", f"acc_{axis}_mps2")]
    table_options = ["--time", "t_s", "--temperature", "temp_C", *columns, "--skip-rows", str(CHAMBER_OUTLIERS)]
    run_hgma("import-csv", chamber, "-o", folder / "training", *table_options, "--until", str(CHAMBER_SPLIT))
    run_hgma("import-csv", chamber, "-o", folder / "held_out", *table_options, "--from", str(CHAMBER_SPLIT))
    yield Case(
        "measured IMU in a thermal chamber, last cooling held out",
        folder,
        folder / "training",
        folder / "held_out",
    )


def demonstrate(case: Case) -> bool:
    """Run one case; return whether the node lost nothing and agrees with the offline pipeline."""
    print(f"\n=== {case.name} ===")
    calibration_file, live_bag = case.folder / "calibration.json", case.folder / "live"
    run_hgma("train", case.training, "-o", calibration_file)
    recording, calibration = read_recording(case.held_out), read_calibration(calibration_file)
    rate = max(1.0, recording.duration / WALL_TIME)
    print(
        f"playing {recording.duration:.0f} s of recording to the node, {rate:.0f} times faster than recorded",
        flush=True,
    )
    counts = run_live(case.held_out, calibration_file, live_bag, rate=rate, samples=len(recording.stamps))
    names = topics.TopicNames([f"/{topics.RAW}:=/{topics.COMPENSATED}"])
    live = read_recording(live_bag, names)
    columns = columns_of(calibration.names)
    if not np.array_equal(live.stamps, recording.stamps):
        print(f"FAILED: {len(recording.stamps)} samples played, {len(live.stamps)} came back: {dict(counts)}")
        return False
    offline = compensate_recording(recording, calibration)
    reference = Reference(tuple(channel.reference for channel in calibration.channels))
    evaluation = compare(
        live.stamps,
        recording.values[:, columns],
        live.values[:, columns],
        offline.features[:, 0],
        calibration,
        reference,
    )
    _show(case, evaluation)
    worst = float(np.max(np.abs(live.values[:, columns] - offline.values) / np.maximum(np.abs(offline.values), 1e-300)))
    print(
        f"node: {len(live.stamps)} of {len(recording.stamps)} samples came back with their stamps; "
        f"largest relative difference from `hgma compensate`: {worst:.1e}"
    )
    return worst <= 1e-9


def _show(case: Case, evaluation: Evaluation) -> None:
    picture = case.folder / "before_after.png"
    plot_evaluation(evaluation, picture, f"{case.name}: raw, and as the node published it")
    console.print(table(evaluation, "error of means over 5 s against the training reference, as the node published it"))
    for channel in evaluation.channels:
        before, after = channel.raw.rms_error, channel.compensated.rms_error
        print(f"{channel.name}: RMS error {before:.4g} -> {after:.4g}, {before / after:.1f} times smaller")
    print(f"picture: {picture}")


def _fresh(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def main() -> int:
    """Run all cases; 0 if all went well."""
    os.chdir(Path(__file__).parents[2])
    start = time.monotonic()
    try:
        results = [demonstrate(case) for case in cases()]
    except RefusedError as refusal:
        print(f"error: {refusal}", file=sys.stderr)
        return 2
    print(f"\ndemo took {time.monotonic() - start:.0f} s")
    return 0 if results and all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
