"""From the path of a calibration to what the stream can adopt, without the stream standing still."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from rclpy.node import Node

from hgma_compensation.calibration.document import read_calibration, shown
from hgma_compensation.errors import RefusedError
from hgma_compensation.node.beside import run_beside
from hgma_compensation.node.parameters import CALIBRATION_DIRECTORY, EXPECTED_SENSOR_ID
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.prepared import Histories, Prepared, prepare


class CalibrationLoader:
    """Reads, validates and prepares a calibration in a thread of its own; the executor's thread serves the stream."""

    def __init__(self, node: Node, live: LiveCompensation, serve: Callable[[], None]) -> None:
        """Take what calibrations are held to; ``serve`` compensates what waits in the node's topics."""
        self._live, self._serve = live, serve
        self._directory, self._sensor_id = (
            str(node.get_parameter(row.name).value) for row in (CALIBRATION_DIRECTORY, EXPECTED_SENSOR_ID)
        )

    def load(self, path: str) -> Prepared:
        """Return the calibration of a file, ready to be adopted; raises RefusedError with the reason in one line."""
        directory = Path(self._directory) if self._directory else None
        job = partial(_read_and_prepare, Path(path), directory, self._sensor_id, self._live.histories())
        try:
            return run_beside(job, self._serve)
        except TimeoutError as error:
            raise RefusedError(
                f"calibration {shown(Path(path))}: {error}: check the disk or network that it lies on"
            ) from None


def _read_and_prepare(path: Path, directory: Path | None, sensor_id: str, histories: Histories) -> Prepared:
    calibration = read_calibration(path, directory=directory)
    if sensor_id and calibration.sensor_id != sensor_id:
        raise RefusedError(
            f"calibration {shown(path)}: sensor_id is {calibration.sensor_id!r}, expected_sensor_id is {sensor_id!r}: "
            "give the calibration of the sensor that this node runs for"
        )
    return prepare(calibration, histories)
