"""Paths as commands take them: what each should be, what to say where it is not, and what the shell completes."""

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from hgma_compensation.channels import CHANNELS
from hgma_compensation.cli.folder import METADATA, STORAGE_SUFFIXES, Here, look
from hgma_compensation.errors import RefusedError

MOST_NAMED = 3
"""Files of the present folder that a refusal names."""

_SAFE = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-+/@%")
"""What a shell takes as it is; names with other characters are left to the shell's own completion."""


class PathArgument(click.Path):
    """A path as a pathlib.Path; whether it exists is said by whoever opens it, with the remedy."""

    kind = "file"

    def __init__(self) -> None:
        """Accept any path."""
        super().__init__(path_type=Path)

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Return what fits, in the folder that is being typed and one level below; else the shell looks for itself."""
        folder, _, _ = incomplete.rpartition("/")
        start = Path(folder) if folder else Path("/" if incomplete.startswith("/") else ".")
        beginning = incomplete.removeprefix("./")
        found = sorted({str(path) for path in self.candidates(look(start))})
        prefix = "./" if incomplete.startswith("./") else ""
        fitting = [prefix + name for name in found if name.startswith(beginning) and _SAFE.issuperset(name)]
        return [CompletionItem(name) for name in fitting] or [CompletionItem(incomplete, type="file")]

    def candidates(self, here: Here) -> Iterable[Path]:
        """Return what can be meant here; none: the shell's own completion of files."""
        return ()


class RecordingPath(PathArgument):
    """A rosbag2 folder, or a file of one."""

    kind = "recording"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path; raises RefusedError for what is plainly something else, or not there."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if not path.exists():
            raise RefusedError(
                f"bag {path} does not exist: give a rosbag2 folder or an .mcap or .db3 file{_here(self)}"
            )
        if path.suffix.lower() == ".csv":
            raise RefusedError(f"{path} is a table: make a recording of it first, with hgma import-csv {path} -o BAG")
        if path.is_file() and path.suffix.lower() not in STORAGE_SUFFIXES:
            raise RefusedError(f"{path} is no recording: give a rosbag2 folder or an .mcap or .db3 file{_here(self)}")
        if path.is_dir() and not (path / METADATA).exists() and (inside := look(path).recordings):
            names = ", ".join(str(one.path) for one in inside[:MOST_NAMED])
            raise RefusedError(f"{path} is no recording: give a recording in it, here is {names}")
        return path

    def candidates(self, here: Here) -> Iterable[Path]:
        """Return the recordings."""
        return [one.path for one in here.recordings]


class CalibrationPath(PathArgument):
    """A calibration file."""

    kind = "calibration"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path; raises RefusedError for a folder and for what is not there."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if path.is_dir():
            inside = path / "calibration.json"
            remedy = f"give {inside}" if inside.is_file() else f"give the JSON file written by hgma train{_here(self)}"
            raise RefusedError(f"calibration {path} is a folder: {remedy}")
        if not path.exists():
            raise RefusedError(
                f"calibration {path} does not exist: give the JSON file written by hgma train{_here(self)}"
            )
        return path

    def candidates(self, here: Here) -> Iterable[Path]:
        """Return the calibrations."""
        return [one.path for one in here.calibrations]


class TablePath(PathArgument):
    """A CSV file."""

    kind = "table"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path; raises RefusedError for what is not there."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if not path.exists():
            raise RefusedError(f"table {path} does not exist: give a CSV file with a header line{_here(self)}")
        return path

    def candidates(self, here: Here) -> Iterable[Path]:
        """Return the tables."""
        return [one.path for one in here.tables]


class ScenarioPath(PathArgument):
    """A scenario of the simulation."""

    kind = "scenario"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path; raises RefusedError for what is not there."""
        path = Path(os.fsdecode(super().convert(value, param, ctx)))
        if not path.exists():
            raise RefusedError(
                f"scenario {path} does not exist: give a YAML file such as params/oven_test.yaml{_here(self)}"
            )
        return path

    def candidates(self, here: Here) -> Iterable[Path]:
        """Return the scenarios."""
        return here.scenarios


class ChannelList(click.ParamType):
    """Channels with commas between; they are checked by who uses them."""

    name, kind = "text", "channels"

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        """Return the list with its last channel completed by those that it lacks."""
        before, comma, last = incomplete.rpartition(",")
        left = [channel for channel in CHANNELS if channel not in before.split(",")]
        return [CompletionItem(before + comma + channel) for channel in left if channel.startswith(last)]


KINDS: Sequence[type[click.ParamType]] = (
    PathArgument, RecordingPath, CalibrationPath, TablePath, ScenarioPath, ChannelList,
)  # fmt: skip
"""What the completion knows beside click's own, by the attribute ``kind``."""


def _here(kind: PathArgument) -> str:
    """Return what fits in the present folder, as the end of a refusal."""
    names = [str(path) for path in kind.candidates(look())][:MOST_NAMED]
    return f"; here is {', '.join(names)}" if names else ""
