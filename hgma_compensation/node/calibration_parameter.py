"""The parameter ``calibration_file``: validated whole before it is accepted, swapped whole after."""

from collections.abc import Callable, Iterable

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.errors import RefusedError
from hgma_compensation.node import log
from hgma_compensation.node.calibration_loader import CalibrationLoader
from hgma_compensation.node.parameters import CALIBRATION_FILE
from hgma_compensation.pipeline.prepared import Prepared

NAME = CALIBRATION_FILE.name


class CalibrationParameter:
    """Has the file read in rclpy's on-set callback, hands the calibration over in its post-set callback.

    While a file is read the executor waits in that callback, so that requests are answered one after the other.
    """

    def __init__(self, node: Node, loader: CalibrationLoader, use: Callable[[Prepared], None]) -> None:
        """Follow the parameter, which is declared; ``use`` is called with each calibration that was accepted."""
        self._node, self._loader, self._use = node, loader, use
        self._prepared: Prepared | None = None
        self.accepted: Calibration | None = None
        self.refusal = ""
        node.add_on_set_parameters_callback(self._validate)
        node.add_post_set_parameters_callback(self._apply)

    @property
    def path(self) -> str:
        """The path as it was set last, "" for none."""
        return str(self._node.get_parameter(NAME).value)

    def read(self) -> Prepared | None:
        """Return the calibration of the path that is set, None where none is set or it is refused.

        For a node without topics: no stream is served meanwhile.
        """
        if not self.path:
            return None
        try:
            prepared = self._loader.load_before_stream(self.path)
        except RefusedError as refusal:
            self._refuse(str(refusal))
            return None
        self.refusal = ""
        return prepared

    def set(self, path: str) -> SetParametersResult:
        """Set the parameter as ``ros2 param set`` would; also where the path is the same as before."""
        return self._node.set_parameters_atomically([Parameter(NAME, value=path)])

    def _validate(self, parameters: Iterable[Parameter]) -> SetParametersResult:
        self._prepared = None
        for parameter in parameters:
            if parameter.name != NAME:
                continue
            try:
                self._prepared = self._load(parameter.value)
            except RefusedError as refusal:
                self._refuse(str(refusal))
                return SetParametersResult(successful=False, reason=str(refusal))
        return SetParametersResult(successful=True)

    def _apply(self, parameters: Iterable[Parameter]) -> None:
        if self._prepared is not None and any(parameter.name == NAME for parameter in parameters):
            prepared, self._prepared, self.refusal = self._prepared, None, ""
            self.accepted = prepared.pipeline.calibration
            self._use(prepared)

    def _refuse(self, reason: str) -> None:
        self.refusal = reason
        log.error(self._node, reason)
        self._loader.serve()  # The log takes a sample's time.

    def _load(self, value: object) -> Prepared:
        if not isinstance(value, str) or not value:
            raise RefusedError(f"{NAME} must be the path of a calibration file")
        return self._loader.load(value)
