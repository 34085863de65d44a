"""The folders of a fleet: one for each sensor, with its recordings in it."""

from fnmatch import fnmatchcase
from pathlib import Path

from hgma_compensation.calibration.calibration import LONGEST_SENSOR_ID
from hgma_compensation.errors import RefusedError
from hgma_compensation.plain_values import is_text

STORAGES = (".mcap", ".db3")
METADATA = "metadata.yaml"
HOLDOUTS = ("holdout*", "accept*")
"""Names of recordings to judge on, where none is named."""


def sensor_names(source: Path) -> tuple[str, ...]:
    """Return the names of the sensors, sorted: those of the folders that are not hidden.

    Raises RefusedError where there is none, or one has a name that no file could carry on.
    """
    if not source.is_dir():
        raise RefusedError(f"{source} is no directory: give the folder that holds a folder for each sensor")
    if (source / METADATA).exists():
        raise RefusedError(f"{source} is itself a recording: give the folder that holds a folder for each sensor")
    try:
        names = sorted(path.name for path in source.iterdir() if path.is_dir() and not path.name.startswith("."))
    except OSError as error:
        raise RefusedError(f"{source} cannot be read ({error.strerror}): check its permissions") from None
    if not names:
        raise RefusedError(f"{source} holds no folder: make one for each sensor, with its recordings in it")
    for name in names:
        if not is_text(name):
            raise RefusedError(f"{source} holds a folder whose name is no printable text, {name!a}: rename it")
        if len(name) > LONGEST_SENSOR_ID:
            raise RefusedError(f"folder {name} has a name of more than {LONGEST_SENSOR_ID} characters: rename it")
    return tuple(names)


def recordings_of(folder: Path) -> tuple[Path, ...]:
    """Return the recordings of a sensor, sorted by name; the folder itself where it is one.

    A folder that holds storage files but no metadata counts: who reads it says what is to be done. Raises RefusedError
    where there is none.
    """
    try:
        if (folder / METADATA).exists():
            return (folder,)
        found = sorted(path for path in folder.iterdir() if not path.name.startswith(".") and _is_recording(path))
    except OSError as error:
        raise RefusedError(f"{folder} cannot be read ({error.strerror}): check its permissions") from None
    if not found:
        raise RefusedError(
            f"{folder} holds no recording: put rosbag2 folders or .mcap or .db3 files there "
            "(a table becomes one with hgma import-csv)"
        )
    return tuple(found)


def _is_recording(path: Path) -> bool:
    if not path.is_dir():
        return path.suffix in STORAGES
    return (path / METADATA).exists() or any(file.suffix in STORAGES for file in path.iterdir())


def holdout_of(recordings: tuple[Path, ...], pattern: str | None) -> Path | None:
    """Return the recording to judge on: the one that the pattern names, or one of HOLDOUTS; None where there is none.

    Upper and lower case are the same, a file's suffix may be left out. Raises RefusedError where the pattern names
    none, where several are named, and where nothing is left to train on.
    """
    patterns = HOLDOUTS if pattern is None else (pattern,)
    found = [path for path in recordings if any(_is_named(path, one) for one in patterns)]
    names = ", ".join(path.name for path in recordings)
    if not found and pattern is not None:
        raise RefusedError(f"no recording is named {pattern} (there are {names}): change --holdout or rename one")
    if len(found) > 1:
        several = ", ".join(path.name for path in found)
        raise RefusedError(f"{several} are all to be judged on: name one of them with --holdout, or rename the others")
    if found and len(recordings) == 1:
        raise RefusedError(f"{names} is the only recording and to be judged on: add one to train on, or rename it")
    return found[0] if found else None


def _is_named(path: Path, pattern: str) -> bool:
    return any(fnmatchcase(name.lower(), pattern.lower()) for name in (path.name, path.stem))
