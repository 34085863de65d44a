"""The parameter ``calibration_file``: validated whole before it is accepted, swapped whole after."""

from collections.abc import Callable, Iterable
from pathlib import Path

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.errors import RefusedError
from hgma_compensation.node.parameters import CALIBRATION_FILE

NAME = CALIBRATION_FILE.name


class CalibrationParameter:
    """Reads the file in rclpy's on-set callback, hands the calibration over in its post-set callback."""

    def __init__(self, node: Node, use: Callable[[Calibration], None]) -> None:
        """Follow the parameter, which is declared; ``use`` is called with each calibration that was accepted."""
        self._node, self._use = node, use
        self._prepared: Calibration | None = None
        self.accepted: Calibration | None = None
        self.refusal = ""
        node.add_on_set_parameters_callback(self._validate)
        node.add_post_set_parameters_callback(self._apply)

    @property
    def path(self) -> str:
        """The path as it was set last, "" for none."""
        return str(self._node.get_parameter(NAME).value)

    def read(self) -> Calibration | None:
        """Return the calibration of the path that is set, None where none is set or it is refused."""
        if not self.path:
            return None
        try:
            calibration = read_calibration(Path(self.path))
        except RefusedError as refusal:
            self._refuse(str(refusal))
            return None
        self.refusal = ""
        return calibration

    def set(self, path: str) -> SetParametersResult:
        """Set the parameter as ``ros2 param set`` would; also where the path is the same as before."""
        return self._node.set_parameters_atomically([Parameter(NAME, value=path)])

    def _validate(self, parameters: Iterable[Parameter]) -> SetParametersResult:
        self._prepared = None
        for parameter in parameters:
            if parameter.name != NAME:
                continue
            try:
                self._prepared = _read(parameter.value)
            except RefusedError as refusal:
                self._refuse(str(refusal))
                return SetParametersResult(successful=False, reason=str(refusal))
        return SetParametersResult(successful=True)

    def _apply(self, parameters: Iterable[Parameter]) -> None:
        if self._prepared is not None and any(parameter.name == NAME for parameter in parameters):
            self.accepted, self._prepared, self.refusal = self._prepared, None, ""
            self._use(self.accepted)

    def _refuse(self, reason: str) -> None:
        self.refusal = reason
        self._node.get_logger().error(reason)


def _read(value: object) -> Calibration:
    if not isinstance(value, str) or not value:
        raise RefusedError(f"{NAME} must be the path of a calibration file")
    return read_calibration(Path(value))
