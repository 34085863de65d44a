"""The managed node ``compensation_node``."""

from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn

from hgma_compensation.node import log, parameters
from hgma_compensation.node.calibration_loader import CalibrationLoader
from hgma_compensation.node.calibration_parameter import CalibrationParameter
from hgma_compensation.node.managed_node import ManagedNode, reported
from hgma_compensation.node.state_keeper import StateKeeper
from hgma_compensation.node.streams import Streams
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.prepared import Prepared
from hgma_compensation.pipeline.status import UNUSABLE

TICK = 0.5
"""s of wall time within which a driver that cannot be heard is noticed."""


class CompensationNode(ManagedNode):
    """Raw acceleration and thermistor in, compensated acceleration and state out.

    Inactive means no output; thermometers and supply voltage are followed from the configured state on, so that
    their history is there when the node becomes active.
    """

    def __init__(self) -> None:
        """Declare parameters; topics come with the transition to inactive, services and diagnostics with ``offer``."""
        super().__init__("compensation_node")
        # Before anything follows a parameter: the file given at the start is read when the node configures.
        parameters.declare(self)
        parameters.warn_of_unknown(self, qos=False)
        self._autostart = bool(self.get_parameter(parameters.AUTOSTART.name).value)
        self._live = LiveCompensation()
        if self.get_parameter(parameters.ON_BAD_TEMPERATURE.name).value == "stop":
            self._live.stop_on = UNUSABLE
        frame_id, state_rate = (
            self.get_parameter(row.name).value for row in (parameters.FRAME_ID, parameters.STATE_RATE)
        )
        self.streams = Streams(self, self._live, frame_id=frame_id, state_rate=state_rate)
        self._keeper = StateKeeper(self, self._live)
        self._state = "unconfigured"
        self._loader = CalibrationLoader(self, self._live, self.streams.serve)
        self._calibration = CalibrationParameter(self, self._loader, self._accept)

    def start(self) -> None:
        """Configure and activate, unless the parameter autostart is false."""
        if self._state != "unconfigured":
            return
        if not self._autostart:
            log.info(self, "waiting to be configured: autostart is false")
            return
        if self.trigger_configure() is TransitionCallbackReturn.SUCCESS:
            self.trigger_activate()

    def offer(self) -> None:
        """Create services and diagnostics, once; the first sample does not wait for them.

        With their modules they take as long as several samples: the stream is served in between.
        """
        serve = self.streams.serve
        serve()
        from hgma_compensation.node.services import Services

        serve()
        Services(self, self._live, self.streams.states, self._calibration, self._keeper)
        serve()
        from hgma_compensation.node.reporting import Reporting

        serve()
        reporters = self._keeper, self.streams.endpoints.events, self.streams.latency
        Reporting(self, self._live, reporters, lambda: (self._state, self._calibration.refusal))
        # On the steady clock: simulated time may stand still because of what the events tell.
        self.create_timer(TICK, self._on_tick, clock=Clock(clock_type=ClockType.STEADY_TIME))
        serve()

    # Transitions ------------------------------------------------------------------------------------

    @reported
    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the calibration, if one is set, and open the topics; a refused file fails the transition."""
        if self._calibration.path:
            prepared = self._calibration.read()
            if prepared is None:
                return TransitionCallbackReturn.FAILURE
            self._use(prepared)
        self._keeper.begin()
        self.streams.open()
        parameters.warn_of_unknown(self, qos=True)
        self._enter("inactive")
        return super().on_configure(state)

    @reported
    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Begin to publish."""
        if self._live.calibration is None:
            log.warning(self, "no calibration yet: set the parameter calibration_file or call ~/load_calibration")
        self._enter("active")
        return super().on_activate(state)

    @reported
    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop publishing; the thermistor is still followed."""
        self._enter("inactive")
        self._keeper.save()
        return super().on_deactivate(state)

    @reported
    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Close the topics and forget calibration and history."""
        self.streams.close()
        self._keeper.finish()
        self._live.remove_calibration()
        self._live.reset()
        self._enter("unconfigured")
        return super().on_cleanup(state)

    @reported
    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Close the topics."""
        self.streams.close()
        self._keeper.finish()
        self._enter("finalized")
        return super().on_shutdown(state)

    @reported
    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Return to unconfigured, from where the node can be configured again."""
        self._enter("finalized")  # where rclpy leads if cleaning up fails too
        log.error(self, "closing all topics after the error; configure the node when its cause is removed")
        return self.on_cleanup(state)

    def destroy_node(self) -> None:
        """Save what is to be kept over a restart, and end."""
        self._loader.close()
        self._keeper.finish()
        self.streams.endpoints.waiting.close()
        super().destroy_node()

    def _enter(self, state: str) -> None:
        self._state, self.streams.publishing = state, state == "active"

    # Calibration ------------------------------------------------------------------------------------

    def _accept(self, prepared: Prepared) -> None:
        """Take a calibration that was set; a node whose first one was refused starts with it."""
        if self._state == "unconfigured":
            self.start()
        else:
            self._use(prepared)

    def _use(self, prepared: Prepared) -> None:
        """Swap the calibration; callbacks run one at a time, so this happens between two samples."""
        self._live.adopt(prepared)
        self.streams.states.reset()
        # The log, and rclpy's announcement and answer after it, take a sample's time each: what came goes before them.
        self.streams.serve()
        calibration = prepared.pipeline.calibration
        log.info(self, f"using calibration {calibration.calibration_id} of sensor {calibration.sensor_id}")
        self.streams.serve()

    def _on_tick(self) -> None:
        self.streams.endpoints.take_events()
        self._loader.start_process()
