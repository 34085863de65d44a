"""The peak memory of the offline commands on a recording of a day, against that on one of an hour."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from benchmarks.bench.bags import Content, bag
from benchmarks.bench.commands import Run, run, run_writing
from benchmarks.bench.given import Given
from benchmarks.bench.offline import compensate
from benchmarks.bench.row import Result, Row, Target, alternate
from hgma_compensation.demo.processes import HGMA
from hgma_compensation.recording.bag_writer import Storage

GROUP = "memory"
LONG, SHORT = 24, 1
"""h of the two recordings."""

HOUR = 3600.0
CONTENTS = {
    "messages at 5 Hz": Content(seconds=HOUR, rate=5.0),
    "blocks at 100 Hz": Content(seconds=HOUR, rate=100.0, block=1000),
}
MOST_REPETITIONS = 3
"""What a process occupies hardly differs from one run to the next."""


def measure(given: Given) -> Result:
    """Return a row for each command and each kind of message."""
    calibration, output = given.calibrations.plain(), given.scratch / "output"
    train: list[str | Path] = ["--channels", "linear_acceleration.z", "-o", output]
    commands: dict[str, Callable[[Path], Run]] = {
        "compensate": lambda source: compensate(source, calibration, Storage.MCAP, output),
        "evaluate": lambda source: run([*HGMA, "evaluate", source, "--calibration", calibration]),
        "train": lambda source: run_writing(output, [*HGMA, "train", source, *train]),
        "diagnose": lambda source: run_writing(
            output, [*HGMA, "diagnose", source, "--calibration", calibration, "-o", output]
        ),
    }
    rows = []
    for name, content in CONTENTS.items():
        recordings = tuple(bag(replace(content, seconds=h * HOUR), given.bags) for h in (LONG, SHORT))
        for command, execute in commands.items():
            # A diagnosis of a day takes a minute or more, and as much memory each time.
            repetitions = 1 if command == "diagnose" else given.repetitions
            rows.append(_row(f"hgma {command}, {LONG} h of {name}", execute, recordings, repetitions))
            given.say(f"{rows[-1].name}: {rows[-1].ratio:.2f}")
    return Result(tuple(rows))


def _row(name: str, execute: Callable[[Path], Run], recordings: tuple[Path, ...], repetitions: int) -> Row:
    long, short = recordings
    figures = alternate(
        min(repetitions, MOST_REPETITIONS),
        lambda: execute(long).peak_megabytes,
        lambda: execute(short).peak_megabytes,
    )
    return Row(GROUP, name, "MB", f"that of {SHORT} h", *figures, Target(1.1))
