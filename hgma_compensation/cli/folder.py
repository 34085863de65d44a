"""What lies in a folder that a command could be given: recordings, calibrations, tables, scenarios.

Quick and bounded: the folder and one level below, the beginnings of files only. Hence it guesses; whoever opens a file
afterwards judges it. Nothing heavy is imported, for it also serves the completion of the shell.
"""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from hgma_compensation.bounded_files import open_regular
from hgma_compensation.errors import RefusedError

MOST_HERE, MOST_BELOW, MOST_FILES = 300, 60, 300
"""Entries that are looked at in the folder, in each folder below it, and files whose beginning is read in all."""

HEAD = 4096
METADATA_HEAD = 1 << 16
"""Bytes of the beginning that is read; the topics of a bag come after the list of its files."""

FEWEST_SENSORS, MOST_SENSORS = 2, 4
"""Folders of sensors that make a fleet, and that are looked into: of one that is large the first tell enough."""

SUMMARY_JSON, SUMMARY_PAGE = "summary.json", "summary.html"
"""What hgma fleet leaves (fleet.run, which takes long to load)."""

METADATA, STORAGE_SUFFIXES = "metadata.yaml", (".mcap", ".db3")

_CALIBRATION_ID = re.compile(r'"calibration_id":\s*"(sha256-[0-9a-f]{16})"')
_SCENARIO = re.compile(r"^scenario:\s*\d", re.MULTILINE)
_BAG_DURATION = re.compile(r"^  duration:\s*\n\s+nanoseconds:\s*(\d{1,18})", re.MULTILINE)


@dataclass(frozen=True)
class Topic:
    """A topic of a recording as its metadata declare it; messages: their number."""

    name: str
    type: str
    messages: int


@dataclass(frozen=True)
class RecordingHere:
    """A rosbag2 folder or file. duration: s; topics and duration are unknown for a file without a folder."""

    path: Path
    topics: tuple[Topic, ...] = ()
    duration: float | None = None


@dataclass(frozen=True)
class CalibrationHere:
    """A calibration file."""

    path: Path
    calibration_id: str


@dataclass(frozen=True)
class TableHere:
    """A CSV file: the fields of its first line, and of its second."""

    path: Path
    columns: tuple[str, ...]
    first_row: tuple[str, ...] = ()


@dataclass
class Here:
    """What was found, paths as a command takes them.

    fleets: folders that hold a folder with recordings for each of several sensors. fleet_results: made of those.
    unfinished: folders with a storage file but without metadata. names: all entries of the folder itself.
    """

    recordings: list[RecordingHere] = field(default_factory=list)
    calibrations: list[CalibrationHere] = field(default_factory=list)
    tables: list[TableHere] = field(default_factory=list)
    scenarios: list[Path] = field(default_factory=list)
    diagnoses: list[Path] = field(default_factory=list)
    unfinished: list[Path] = field(default_factory=list)
    fleets: list[Path] = field(default_factory=list)
    fleet_results: list[Path] = field(default_factory=list)
    names: frozenset[str] = frozenset()


def look(folder: Path = Path()) -> Here:
    """Return what lies in a folder and one level below; what cannot be read is passed over."""
    here = Here()
    entries = _entries(folder, MOST_HERE)
    here.names = frozenset(entry.name for entry in entries)
    files = [folder / entry.name for entry in entries if not _is_folder(entry)]
    for entry in entries:
        if _is_folder(entry) and not entry.name.startswith(("__", "venv")):
            path = folder / entry.name
            if not _take_bag(here, path):
                below = _entries(path, MOST_BELOW)
                if {"diagnosis.json", "calibration.json"} <= {one.name for one in below}:
                    here.diagnoses.append(path)
                if {SUMMARY_JSON, SUMMARY_PAGE} <= {one.name for one in below}:
                    here.fleet_results.append(path)
                    continue  # its files are of the whole fleet
                files += [path / one.name for one in below if not _is_folder(one)]
                folders = [path / one.name for one in below if _is_folder(one)]
                sensors = [one for one in folders if not _take_bag(here, one)]
                if sum(map(_holds_recordings, sensors[:MOST_SENSORS])) >= FEWEST_SENSORS:
                    here.fleets.append(path)
    for file in files[:MOST_FILES]:
        _take_file(here, file)
    return here


def recording_at(path: Path) -> RecordingHere | None:
    """Return a folder as the recording that its metadata declare, None where it has none."""
    here = Here()
    _take_bag(here, path)
    return here.recordings[0] if here.recordings else None


def _entries(folder: Path, most: int) -> list["os.DirEntry[str]"]:
    try:
        with os.scandir(folder) as found:
            first = [entry for entry in islice(found, most) if not entry.name.startswith(".")]
    except OSError:
        return []
    return sorted((entry for entry in first if entry.name.isprintable()), key=lambda entry: entry.name)


def _is_folder(entry: "os.DirEntry[str]") -> bool:
    try:
        return entry.is_dir()
    except OSError:
        return False


def _take_bag(here: Here, path: Path) -> bool:
    """Add a folder, where it is a recording, and return whether it is."""
    if os.path.isfile(path / METADATA):  # False also where the folder may not be looked into
        text = _head(path / METADATA, METADATA_HEAD)
        if "rosbag2_bagfile_information" not in text:
            return False
        lasts = _BAG_DURATION.search(text)
        duration = int(lasts.group(1)) / 1e9 if lasts else None
        here.recordings.append(RecordingHere(path, tuple(_topics(text)), duration))
        return True
    if any(Path(entry.name).suffix in STORAGE_SUFFIXES for entry in _entries(path, MOST_BELOW)):
        here.unfinished.append(path)
        return True
    return False


def _holds_recordings(folder: Path) -> bool:
    return any(
        os.path.isfile(folder / entry.name / METADATA) or Path(entry.name).suffix in STORAGE_SUFFIXES
        for entry in _entries(folder, MOST_BELOW)
    )


def _take_file(here: Here, path: Path) -> None:
    suffix = path.suffix.lower()
    if suffix in STORAGE_SUFFIXES:
        here.recordings.append(RecordingHere(path))
    elif suffix == ".json":
        head = _head(path)
        identity = _CALIBRATION_ID.search(head)
        if '"hgma_calibration"' in head and identity:
            here.calibrations.append(CalibrationHere(path, identity.group(1)))
    elif suffix == ".csv":
        rows = [tuple(cell.strip() for cell in line.split(",")) for line in _head(path).splitlines()[:2]]
        if rows and len(rows[0]) > 1:
            here.tables.append(TableHere(path, *rows))
    elif suffix in (".yaml", ".yml") and _SCENARIO.search(_head(path)):
        here.scenarios.append(path)


def _head(path: Path, length: int = HEAD) -> str:
    """Return the beginning of a file as text, "" where it cannot be read."""
    try:
        with open_regular(path) as file:
            return file.read(length).decode("utf-8-sig", errors="replace")
    except (OSError, RefusedError):
        return ""


def _topics(metadata: str) -> Iterator[Topic]:
    """Yield the topics in the text of a metadata.yaml: by patterns, since a YAML parser takes long to load."""
    lines = metadata.partition("topics_with_message_count:")[2].splitlines()
    begins = [index for index, line in enumerate(lines) if line.lstrip().startswith("- ")]
    if not begins:
        return
    indent = len(lines[begins[0]]) - len(lines[begins[0]].lstrip())
    begins = [index for index in begins if len(lines[index]) - len(lines[index].lstrip()) == indent]
    for begin, end in zip(begins, [*begins[1:], len(lines)], strict=True):
        item = "\n".join(lines[begin:end])
        fields = [re.search(rf"\b{name}:\s*['\"]?([^\s'\"]+)", item) for name in ("name", "type", "message_count")]
        name, kind, messages = (found.group(1) if found else "" for found in fields)
        if name and kind and messages.isdecimal():
            yield Topic(name, kind, int(messages))
