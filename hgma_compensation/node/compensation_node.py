"""The managed node ``compensation_node``."""

from collections.abc import Callable
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from sensor_msgs.msg import Imu, Temperature
from std_msgs.msg import Header
from std_srvs.srv import Trigger

from hgma_compensation import topics
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.errors import RefusedError
from hgma_compensation.messages import (
    block_samples,
    imu_values,
    patch_block,
    patch_imu,
    stamp_of,
    widen_block,
)
from hgma_compensation.node.calibration_parameter import CalibrationParameter
from hgma_compensation.node.diagnostics import DiagnosticReport
from hgma_compensation.node.interfaces import INPUT_QOS, OUTPUT_QOS, drain, overridable
from hgma_compensation.pipeline.live import LiveCompensation, LiveResult, single_sample
from hgma_compensation.pipeline.reasons import Skip
from hgma_compensation.pipeline.state_fields import state_fields
from hgma_msgs.msg import AccelBlock, CompensationState, SupplyVoltage
from hgma_msgs.srv import LoadCalibration

DIAGNOSTIC_PERIOD = 1.0


class CompensationNode(LifecycleNode):
    """Raw acceleration and thermistor in, compensated acceleration and state out.

    Inactive means no output; thermometers and supply voltage are followed from the configured state on, so that
    their history is there when the node becomes active.
    """

    def __init__(self) -> None:
        """Declare parameters and services; topics come with the transition to inactive."""
        super().__init__("compensation_node")
        autostart = ParameterDescriptor(description="Configure and activate at start-up", read_only=True)
        self._autostart = bool(self.declare_parameter("autostart", True, autostart).value)
        self._live = LiveCompensation()
        self._state = "unconfigured"
        self._slow: list[tuple[Any, Callable[[Any], None]]] = []
        self._entities: list[Any] = []
        self._calibration = CalibrationParameter(self, self._accept)
        self.create_service(LoadCalibration, "~/load_calibration", self._on_load)
        self.create_service(Trigger, "~/reset", self._on_reset)
        self._report = DiagnosticReport(f"{self.get_fully_qualified_name().lstrip('/')}: compensation")
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._reported_at = self.get_clock().now()
        self.create_timer(DIAGNOSTIC_PERIOD, self._on_diagnostics)

    def start(self) -> None:
        """Configure and activate, unless the parameter autostart is false."""
        if self._state != "unconfigured":
            return
        if not self._autostart:
            self.get_logger().info("waiting to be configured: autostart is false")
            return
        if self.trigger_configure() is TransitionCallbackReturn.SUCCESS:
            self.trigger_activate()

    # Transitions ------------------------------------------------------------------------------------

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the calibration, if one is set, and open the topics; a refused file fails the transition."""
        if self._calibration.path:
            calibration = self._calibration.read()
            if calibration is None:
                return TransitionCallbackReturn.FAILURE
            self._use(calibration)
        self._open_topics()
        self._state = "inactive"
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Begin to publish."""
        if self._live.calibration is None:
            self.get_logger().warning(
                "no calibration yet: set the parameter calibration_file or call ~/load_calibration"
            )
        self._state = "active"
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop publishing; the thermistor is still followed."""
        self._state = "inactive"
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Close the topics and forget calibration and history."""
        self._close_topics()
        self._live.remove_calibration()
        self._live.reset()
        self._state = "unconfigured"
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Close the topics."""
        self._close_topics()
        self._state = "finalized"
        return super().on_shutdown(state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Return to unconfigured, from where the node can be configured again."""
        return self.on_cleanup(state)

    def _open_topics(self) -> None:
        subscribe = partial(self.create_subscription, qos_profile=INPUT_QOS, qos_overriding_options=overridable())
        publish = partial(self.create_lifecycle_publisher, qos_profile=OUTPUT_QOS, qos_overriding_options=overridable())
        # The slow inputs first: where both wait, the executor then serves them before the accelerometer.
        self._slow = [
            (subscribe(message_type, topic, take), take)
            for message_type, topic, take in (
                (Temperature, topics.TEMPERATURE, self._take_temperature),
                (Temperature, topics.TEMPERATURE_2, self._take_temperature_2),
                (SupplyVoltage, topics.SUPPLY_VOLTAGE, self._take_supply_voltage),
            )
        ]
        self._raw = subscribe(Imu, topics.RAW, self._on_raw)
        self._raw_block = subscribe(AccelBlock, topics.RAW_BLOCK, self._on_raw_block)
        self._compensated = publish(Imu, topics.COMPENSATED)
        self._compensated_block = publish(AccelBlock, topics.COMPENSATED_BLOCK)
        self._states = publish(CompensationState, topics.STATE)

    def _close_topics(self) -> None:
        if not self._slow:
            return
        for subscription in (*(slow for slow, _ in self._slow), self._raw, self._raw_block):
            self.destroy_subscription(subscription)
        for publisher in (self._compensated, self._compensated_block, self._states):
            self.destroy_lifecycle_publisher(publisher)
        self._slow = []

    # Samples ----------------------------------------------------------------------------------------

    def _take_temperature(self, message: Temperature) -> None:
        self._live.add_temperature(stamp_of(message), message.temperature)

    def _take_temperature_2(self, message: Temperature) -> None:
        self._live.add_temperature_2(stamp_of(message), message.temperature)

    def _take_supply_voltage(self, message: SupplyVoltage) -> None:
        self._live.add_supply_voltage(stamp_of(message), message.voltage)

    def _drain_slow(self) -> None:
        """Take every waiting sample of thermometers and supply voltage.

        Called after accelerations were taken and before they are compensated: a slow sample that was sent before one
        of them is then among those taken here.
        """
        for subscription, take in self._slow:
            for message in drain(subscription):
                take(message)

    def _on_raw(self, message: Imu) -> None:
        waiting = [message, *drain(self._raw)]
        self._drain_slow()
        for taken in waiting:
            self._compensate(taken)

    def _compensate(self, message: Imu) -> None:
        if self._state != "active":
            return self._live.skip_unseen(Skip.NOT_ACTIVE, 1)
        result = self._live.compensate(*single_sample(stamp_of(message), imu_values(message)))
        if result is not None:
            patch_imu(message, result.calibration.names, result.compensated.values[0].tolist())
            self._compensated.publish(message)
            self._publish_state(message.header, result)

    def _on_raw_block(self, message: AccelBlock) -> None:
        self._drain_slow()
        if self._state != "active":
            return self._live.skip_unseen(Skip.NOT_ACTIVE, len(message.x))
        try:
            stamps, values = block_samples(message, topics.RAW_BLOCK)
        except RefusedError:
            return self._live.skip_unseen(Skip.MALFORMED_BLOCK, max(len(message.x), 1))
        result = self._live.compensate(stamps, widen_block(values)) if len(stamps) else None
        if result is not None:
            patch_block(message, result.calibration.names, result.compensated.values)
            self._compensated_block.publish(message)
            self._publish_state(message.header, result)

    def _publish_state(self, header: Header, result: LiveResult) -> None:
        fields = state_fields(result.calibration, result.compensated, -1)
        self._states.publish(CompensationState(header=header, **fields))

    # Calibration, reset, diagnostics ----------------------------------------------------------------

    def _accept(self, calibration: Calibration) -> None:
        """Take a calibration that was set; a node whose first one was refused starts with it."""
        if self._state == "unconfigured":
            self.start()
        else:
            self._use(calibration)

    def _use(self, calibration: Calibration) -> None:
        """Swap the calibration; callbacks run one at a time, so this happens between two samples."""
        self._live.install(calibration)
        self.get_logger().info(f"using calibration {calibration.calibration_id} of sensor {calibration.sensor_id}")

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
        response.success, response.message = True, "filter, memories and history cleared, calibration kept"
        return response

    def _on_diagnostics(self) -> None:
        now = self.get_clock().now()
        elapsed = (now - self._reported_at).nanoseconds * 1e-9
        self._reported_at = now
        status = self._report.status(self._live, self._state, self._calibration.refusal, elapsed)
        array = DiagnosticArray(status=[status])
        array.header.stamp = now.to_msg()
        self._diagnostics.publish(array)
