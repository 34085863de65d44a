"""The time of ``hgma compensate`` against that of reading and writing the same bag with rosbags, nothing between."""

import sys
from dataclasses import replace
from pathlib import Path

from benchmarks.bench.bags import Content, bag
from benchmarks.bench.commands import Run, run_writing
from benchmarks.bench.given import Given
from benchmarks.bench.row import Result, Row, Target, alternate
from hgma_compensation.demo.processes import HGMA
from hgma_compensation.recording.bag_writer import Storage

GROUP, RIVAL = "offline", "rosbags, read and write"
FEWEST_REPETITIONS = 7
"""A run takes seconds, and the file system's share of them changes from one to the next."""

CONTENTS = {
    "500 000 messages": Content(seconds=500.0, rate=1000.0, thermistor_rate=10.0),
    "2000 blocks of 10 000": Content(seconds=200.0, rate=100_000.0, block=10_000, thermistor_rate=10.0),
}


def measure(given: Given) -> Result:
    """Return a row for each kind of message and each storage."""
    rows = []
    for name, content in CONTENTS.items():
        for storage in Storage:
            source = bag(replace(content, storage=storage), given.bags)
            rows.append(_row(f"hgma compensate, {name}, {storage.value}", source, storage, given))
            given.say(f"{rows[-1].name}: {rows[-1].ratio:.2f}")
    return Result(tuple(rows))


def _row(name: str, source: Path, storage: Storage, given: Given) -> Row:
    calibration, output = given.calibrations.plain(), given.scratch / "output"
    figures = alternate(
        max(given.repetitions, FEWEST_REPETITIONS),
        lambda: compensate(source, calibration, storage, output).seconds,
        lambda: copy(source, storage, output).seconds,
    )
    return Row(GROUP, name, "s", RIVAL, *figures, Target(1.5))


def compensate(source: Path, calibration: Path, storage: Storage, output: Path) -> Run:
    """Run ``hgma compensate``; the output is removed again."""
    command = [*HGMA, "compensate", source, "--calibration", calibration, "--storage", storage.value, "-o", output]
    return run_writing(output, command)


def copy(source: Path, storage: Storage, output: Path) -> Run:
    """Read and write the bag; the output is removed again."""
    return run_writing(output, [sys.executable, "-m", "benchmarks.bench.copy_bag", source, output, storage.value])
