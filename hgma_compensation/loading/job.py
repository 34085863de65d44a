"""What is asked of the loading process, and what it answers."""

from dataclasses import dataclass
from pathlib import Path

from hgma_compensation.calibration.document import read_calibration, shown
from hgma_compensation.errors import RefusedError
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.prepared import Histories, prepare


@dataclass(frozen=True)
class Request:
    """A calibration's path, what it is held to, and the slow inputs so far.

    directory: where the file must lie, None for anywhere. sensor_id: the one it must have, "" for any.
    """

    path: Path
    directory: Path | None
    sensor_id: str
    histories: Histories


@dataclass(frozen=True)
class Refusal:
    """Why a calibration is not used."""

    reason: str


def answer(request: Request) -> Pipeline | Refusal:
    """Return the pipeline of the calibration, which knows the histories, or why there is none."""
    try:
        return _read_and_prepare(request)
    except RefusedError as refusal:
        return Refusal(str(refusal))


def _read_and_prepare(request: Request) -> Pipeline:
    calibration = read_calibration(request.path, directory=request.directory)
    if request.sensor_id and calibration.sensor_id != request.sensor_id:
        raise RefusedError(
            f"calibration {shown(request.path)}: sensor_id is {calibration.sensor_id!r}, expected_sensor_id is "
            f"{request.sensor_id!r}: give the calibration of the sensor that this node runs for"
        )
    return prepare(calibration, request.histories).pipeline
