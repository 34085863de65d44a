"""From the path of a calibration to what the stream can adopt, without the stream standing still."""

from collections.abc import Callable
from pathlib import Path

from rclpy.node import Node

from hgma_compensation.calibration.document import shown
from hgma_compensation.errors import RefusedError
from hgma_compensation.loading.job import Request
from hgma_compensation.loading.process import LoadingProcess
from hgma_compensation.node.parameters import CALIBRATION_DIRECTORY, EXPECTED_SENSOR_ID
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.prepared import Prepared


class CalibrationLoader:
    """Has calibrations read, validated and prepared by another process; the executor's thread serves the stream."""

    def __init__(self, node: Node, live: LiveCompensation, serve: Callable[[], None]) -> None:
        """Take what calibrations are held to; ``serve`` compensates what waits in the node's topics."""
        self._live, self.serve = live, serve
        directory, self._sensor_id = (
            str(node.get_parameter(row.name).value) for row in (CALIBRATION_DIRECTORY, EXPECTED_SENSOR_ID)
        )
        self._directory = Path(directory) if directory else None
        # While the node still gets ready, so that the process is ready when the node configures.
        self._process = LoadingProcess()

    def load(self, path: str) -> Prepared:
        """Return the calibration of a file, ready to be adopted; raises RefusedError with the reason in one line."""
        histories = self._live.histories()
        request = Request(Path(path), self._directory, self._sensor_id, histories)
        try:
            return Prepared(self._process.ask(request, self.serve), histories)
        except TimeoutError as error:
            reason = f"{error}: check the disk or network that it lies on"
        except ChildProcessError as error:
            reason = f"{error}: see that this machine has memory left, and try again"
        raise RefusedError(f"calibration {shown(request.path)}: {reason}")

    def close(self) -> None:
        """End the process."""
        self._process.close()
