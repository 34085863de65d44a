"""What became of one sensor, as it stands in its status.json, which is written after everything else."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from hgma_compensation import __version__
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically
from hgma_compensation.fleet.figures import Figures
from hgma_compensation.fleet.options import FleetOptions

STATUS, CALIBRATION, EVALUATION = "status.json", "calibration.json", "evaluation.json"
FORMAT, VERSION = "hgma_fleet_status", 1
LARGEST = 1 << 20


@dataclass(frozen=True)
class Judged:
    """trained_on: recordings. judged_on: recording. limit: s in it at which one part ends and the other begins.

    reference: still values that the residuals are told from, as ``hgma evaluate --reference`` takes them.
    """

    calibration_id: str
    trained_on: tuple[str, ...]
    judged_on: str
    limit: float | None
    reference: str


@dataclass(frozen=True)
class Status:
    """One sensor. judged: None where it could not be calibrated, for the reason given.

    channels: figures by the names of the channels. inputs: what the results were made of, outputs: digests of the files
    that they are in; both are there to tell whether anything changed since.
    """

    sensor: str
    judged: Judged | None = None
    reason: str = ""
    channels: dict[str, Figures] = field(default_factory=dict)
    inputs: dict[str, Any] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)

    @property
    def calibrated(self) -> bool:
        """Whether there is a calibration."""
        return self.judged is not None


def inputs_of(options: FleetOptions, recordings: Sequence[Path], folder: Path) -> dict[str, Any]:
    """Return all that a result depends on: version, options and the content of each file of the recordings.

    Content and not times, so that a fleet may be copied, and finished on another machine.
    """
    files = [file for path in recordings for file in ([path] if path.is_file() else sorted(path.rglob("*")))]
    digests = {str(file.relative_to(folder)): digest(file) for file in files if file.is_file()}
    inputs = {"tool": f"hgma_compensation {__version__}", "options": options.as_json(), "files": digests}
    plain: dict[str, Any] = json.loads(json.dumps(inputs))  # as it is read again: a tuple comes back as a list
    return plain


def digest(file: Path) -> str:
    """Return the SHA-256 of a file's content; raises RefusedError where it cannot be read."""
    total = hashlib.sha256()
    try:
        with open(file, "rb") as content:
            while part := content.read(1 << 20):
                total.update(part)
    except OSError as error:
        raise RefusedError(f"{file} cannot be read ({error.strerror}): check its permissions") from None
    return "sha256-" + total.hexdigest()


def write_status(status: Status, folder: Path) -> None:
    """Write the status of a sensor into its folder; raises RefusedError where it cannot be written."""
    document = {"format": FORMAT, "version": VERSION, **asdict(status)}
    write_atomically(folder / STATUS, (json.dumps(document, indent=1, allow_nan=False) + "\n").encode())


def finished(folder: Path, sensor: str, inputs: dict[str, Any]) -> Status | None:
    """Return the status of a sensor that was calibrated from the same inputs and whose files are as they were written.

    None for anything else, be it damaged, older, or refused: that is done anew.
    """
    try:
        content = (folder / STATUS).read_bytes()[: LARGEST + 1]
        document = json.loads(content) if len(content) <= LARGEST else None
        assert isinstance(document, dict)
        if (document.pop("format"), document.pop("version")) != (FORMAT, VERSION):
            return None
        judged = document.pop("judged")
        status = Status(judged=Judged(**{**judged, "trained_on": tuple(judged["trained_on"])}), **document)
        same = status.sensor == sensor and status.inputs == inputs and set(status.outputs) == {CALIBRATION, EVALUATION}
        whole = same and all(digest(folder / name) == value for name, value in status.outputs.items())
    except (OSError, ValueError, TypeError, KeyError, AttributeError, AssertionError, RecursionError, RefusedError):
        return None
    return status if whole else None
