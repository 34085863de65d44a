"""What to do next with what lies in a folder: the commands to type, filled in with the names found."""

import shlex
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from hgma_compensation import topics
from hgma_compensation.cli.folder import Here, RecordingHere, TableHere
from hgma_compensation.cli.found_here import MOST_NAMED, found
from hgma_compensation.cli.recording_topics import remaps, usable
from hgma_compensation.cli.table_columns import import_options


@dataclass(frozen=True)
class Step:
    """What a command is for, and its words."""

    purpose: str
    words: tuple[str, ...]

    @property
    def command(self) -> str:
        """The line to type."""
        return shlex.join(self.words)


def lines(here: Here, commands: Collection[str], scenario: Path | None = None) -> list[str]:
    """Return what to print: what is here, what to do next, and where the rest is explained.

    commands: names of the commands that there are. scenario: one that comes with the package.
    """
    text = [*found(here), ""]
    for step in steps(here, commands, scenario):
        text += [f"{step.purpose}:", f"    {step.command}"]
    known = ", ".join(commands)
    return [*text, "", f"All commands: {known}. What they do: hgma --help; how one is used: hgma COMMAND --help"]


def steps(here: Here, commands: Collection[str], scenario: Path | None = None) -> list[Step]:
    """Return the next steps, the first of them first; only commands that there are."""
    there = [step for step in _steps(here, scenario) if step.words[0] != "hgma" or step.words[1] in commands]
    return list({step.words: step for step in there}.values())


def _steps(here: Here, scenario: Path | None) -> Iterator[Step]:
    recordings = _sources(here)
    for folder in here.unfinished[:1]:
        yield Step("Finish the recording that was cut off", ("ros2", "bag", "reindex", _path(folder)))
    for folder in here.fleets[:1]:
        output = _path(here.fleet_results[0]) if here.fleet_results else _free(here, "calibrated")
        yield Step(
            "Calibrate and judge every sensor of a folder (the same again does what is missing)",
            ("hgma", "fleet", _path(folder), "-o", output),
        )
    if here.calibrations and recordings:
        yield from _with_both(here, recordings)
    elif here.calibrations:
        yield from _with_calibration(here)
    elif recordings:
        yield from _with_recordings(here, recordings)
    elif here.tables:
        yield from (_import(here, table) for table in here.tables[:MOST_NAMED])
    if not recordings and not here.calibrations and not here.fleets:
        example = next((one for one in here.scenarios if one.stem == "oven_test"), None)
        example = example or (here.scenarios[0] if here.scenarios else scenario)
        if example is not None:
            output = _free(here, example.stem)
            yield Step(
                "Simulate an oven test, to try it without a sensor",
                ("hgma", "simulate", _path(example), "-o", output),
            )
    if not recordings and not here.calibrations and not here.tables and not here.fleets:
        yield Step("Or plan the oven's day", ("hgma", "plan"))
        yield Step(
            "Record your still sensor in the oven",
            (
                "ros2",
                "bag",
                "record",
                "-o",
                _free(here, "oven"),
                *(topics.in_bag(t) for t in (topics.RAW, topics.TEMPERATURE)),
            ),
        )
        yield Step(
            "Or make a recording of a table",
            ("hgma", "import-csv", "TABLE.csv", "-o", _free(here, "oven"), *import_options(())[0]),
        )


def _with_recordings(here: Here, recordings: Sequence[RecordingHere]) -> Iterator[Step]:
    first, bag = recordings[0], _path(recordings[0].path)
    output = _free(here, "calibration", ".json")
    yield Step("See what it can teach", ("hgma", "check", bag, *remaps(first)))
    yield Step(
        "Fit a calibration to it (it must be an oven test of the still sensor)",
        ("hgma", "train", bag, "-o", output, *remaps(first)),
    )


def _with_both(here: Here, recordings: Sequence[RecordingHere]) -> Iterator[Step]:
    # One trains on the longest, so the next one judges; a calibration that a diagnosis has written is the better one.
    best = next((one for one in here.calibrations if one.path.parent in here.diagnoses), here.calibrations[0])
    calibration = _path(best.path)
    judged = recordings[1] if len(recordings) > 1 else recordings[0]
    bag = _path(judged.path)
    yield Step(
        "See the error before and after", ("hgma", "evaluate", bag, "--calibration", calibration, *remaps(judged))
    )
    if not here.diagnoses:
        bags = [_path(one.path) for one in recordings[:1]]
        yield Step(
            "Name what it leaves, and add it",
            (
                "hgma",
                "diagnose",
                *bags,
                "--calibration",
                calibration,
                "-o",
                _free(here, "diagnosis"),
                *remaps(recordings[0]),
            ),
        )
    yield Step(
        "Compensate a recording",
        (
            "hgma",
            "compensate",
            bag,
            "--calibration",
            calibration,
            "-o",
            _free(here, f"{judged.path.stem}_compensated"),
            *remaps(judged),
        ),
    )
    yield from _with_calibration(here, calibration)


def _with_calibration(here: Here, calibration: str | None = None) -> Iterator[Step]:
    path = calibration or _path(here.calibrations[0].path)
    yield Step("See what the calibration holds", ("hgma", "inspect", path))
    yield Step(
        "Run the node with it (-r accel/raw:=imu/data_raw where the driver's topics have other names)",
        ("hgma", "node", "--ros-args", "-p", f"calibration_file:={path}"),
    )
    yield Step("Watch what the node receives and publishes, from another terminal", ("hgma", "watch"))
    yield Step(
        "Or write the cubic that PX4 takes, with what that loses (for ArduPilot: --format ardupilot)",
        ("hgma", "export", path, "--format", "px4", "-o", _free(here, "imu", ".params")),
    )


def _import(here: Here, table: TableHere) -> Step:
    options, missing = import_options(table.columns, table.first_row)
    purpose = f"Make a recording of {table.path} (its columns are guessed by their names)"
    if missing:
        shown = ", ".join(table.columns[:20])
        purpose = f"Make a recording of {table.path} (put a column in the place of COL; it has {shown})"
    return Step(purpose, ("hgma", "import-csv", _path(table.path), "-o", _free(here, table.path.stem), *options))


def _sources(here: Here) -> list[RecordingHere]:
    """Return the recordings that can be trained on, the longest first."""
    return sorted(
        (one for one in here.recordings if usable(one)), key=lambda one: (-(one.duration or 0.0), str(one.path))
    )


def _free(here: Here, stem: str, suffix: str = "") -> str:
    """Return a name that nothing in the folder has yet."""
    tried = [f"{stem}{suffix}", *(f"{stem}_{number}{suffix}" for number in range(2, len(here.names) + 3))]
    return next(_path(Path(name)) for name in tried if name not in here.names)


def _path(path: Path) -> str:
    """Return a path that no command takes for an option."""
    return f"./{path}" if str(path).startswith("-") else str(path)
