"""The node's services: another calibration, a reset."""

from rclpy.node import Node
from std_srvs.srv import Trigger

from hgma_compensation.node.calibration_parameter import CalibrationParameter
from hgma_compensation.node.outputs import States
from hgma_compensation.node.state_keeper import StateKeeper
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_msgs.srv import LoadCalibration


class Services:
    """``~/load_calibration`` and ``~/reset``; rclpy keeps the object with the node."""

    def __init__(
        self,
        node: Node,
        live: LiveCompensation,
        states: States,
        calibration: CalibrationParameter,
        keeper: StateKeeper,
    ) -> None:
        """Take the parts of the node that the services act on."""
        self._live, self._states, self._calibration, self._keeper = live, states, calibration, keeper
        node.create_service(LoadCalibration, "~/load_calibration", self._on_load)
        node.create_service(Trigger, "~/reset", self._on_reset)

    def _on_load(
        self, request: LoadCalibration.Request, response: LoadCalibration.Response
    ) -> LoadCalibration.Response:
        previous = self._live.calibration
        result = self._calibration.set(request.path)
        current = self._calibration.accepted if result.successful else previous
        response.success = result.successful
        response.calibration_id = current.calibration_id if current else ""
        response.previous_calibration_id = previous.calibration_id if previous else ""
        response.message = f"using calibration {response.calibration_id}" if result.successful else result.reason
        return response

    def _on_reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._live.reset()
        self._states.reset()
        cleared = "filter, memories and history cleared, calibration kept"
        response.success, response.message = True, cleared + self._keeper.discard()
        return response
