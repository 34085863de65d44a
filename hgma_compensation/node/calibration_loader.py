"""From the path of a calibration to what the stream can adopt, without the stream standing still."""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError  # another one than the builtin until Python 3.11
from pathlib import Path
from typing import TYPE_CHECKING

from rclpy.node import Node

from hgma_compensation.calibration.document import shown
from hgma_compensation.errors import RefusedError
from hgma_compensation.loading.job import Refusal, Request, answer
from hgma_compensation.node.parameters import CALIBRATION_DIRECTORY, EXPECTED_SENSOR_ID
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.prepared import Prepared

if TYPE_CHECKING:  # else imported with the first process, for which the first sample does not wait
    from hgma_compensation.loading.process import LoadingProcess

PATIENCE = 10.0
"""s after which a disk that does not answer is given up where no stream waits."""


class CalibrationLoader:
    """Has calibrations read, validated and prepared by another process while the stream is served.

    Where there is no stream yet they are read here: a process takes longer to start than a calibration to be read.
    """

    def __init__(self, node: Node, live: LiveCompensation, serve: Callable[[], None]) -> None:
        """Take what calibrations are held to; ``serve`` compensates what waits in the node's topics."""
        self._live, self.serve = live, serve
        directory, self._sensor_id = (
            str(node.get_parameter(row.name).value) for row in (CALIBRATION_DIRECTORY, EXPECTED_SENSOR_ID)
        )
        self._directory = Path(directory) if directory else None
        self._process: LoadingProcess | None = None

    def start_process(self) -> "LoadingProcess":
        """Start the process, if there is none, so that the first request finds it ready."""
        if self._process is None:
            from hgma_compensation.loading.process import LoadingProcess

            self._process = LoadingProcess()
        return self._process

    def load(self, path: str) -> Prepared:
        """Return the calibration of a file, ready to be adopted; raises RefusedError with the reason in one line.

        The stream is served meanwhile.
        """
        return self._load(path, lambda request: self.start_process().ask(request, self.serve))

    def load_before_stream(self, path: str) -> Prepared:
        """Return the same as ``load`` where no stream waits."""
        return self._load(path, answer_of_thread)

    def _load(self, path: str, ask: Callable[[Request], Pipeline]) -> Prepared:
        histories = self._live.histories()
        request = Request(Path(path), self._directory, self._sensor_id, histories)
        try:
            return Prepared(ask(request), histories)
        except TimeoutError as error:
            reason = f"{error}: check the disk or network that it lies on"
        except ChildProcessError as error:
            reason = f"{error}: see that this machine has memory left, and try again"
        raise RefusedError(f"calibration {shown(request.path)}: {reason}")

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.close()


def answer_of_thread(request: Request) -> Pipeline:
    """Return the answer to a request; raises RefusedError, and TimeoutError where it is not there in time.

    The thread touches nothing that others use. One whose disk never answers must not keep the process from ending.
    """
    found: Future[Pipeline | Refusal] = Future()

    def work() -> None:
        try:
            found.set_result(answer(request))
        except BaseException as error:
            found.set_exception(error)

    threading.Thread(target=work, name="loading", daemon=True).start()
    try:
        result = found.result(PATIENCE)
    except FutureTimeoutError:
        raise TimeoutError(f"not done within {PATIENCE:g} s") from None
    if isinstance(result, Refusal):
        raise RefusedError(result.reason)
    return result
