"""A sensor's driver and the listener at the other end, in one thread that is never interrupted by the node's end."""

import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, Temperature

from benchmarks.soak.remembering import Truth, acceleration, past, temperature
from hgma_compensation.messages import stamp_of
from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import CompensationState

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=1000, reliability=ReliabilityPolicy.RELIABLE)
RATE, EVERY = 100, 20
"""Accelerations a second, and how many of them there are to a thermistor sample."""


class Driver:
    """Sends in real time, stamped by the wall clock; collects states and diagnostics; the truth sees what is sent."""

    def __init__(self, domain: int, truth: Truth) -> None:
        """Join a ROS domain."""
        self._context, self._truth = rclpy.Context(), truth
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = rclpy.create_node("driver", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._raw = self._node.create_publisher(Imu, "accel/raw", QOS)
        self._temperature = self._node.create_publisher(Temperature, "accel/temperature", QOS)
        self.drift: dict[int, float] = {}
        self.first_state, self._since = 0.0, 0
        self.diagnostics: list[dict[str, str]] = []
        self._node.create_subscription(CompensationState, "accel/state", self._on_state, QOS)
        self._node.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, QOS)
        self._count = 0
        self.start = time.time_ns()

    def _on_state(self, state: CompensationState) -> None:
        if stamp_of(state) <= self._since:
            return
        if not self.drift:
            self.first_state = time.monotonic()
        self.drift[stamp_of(state)] = float(state.drift[0])

    def _on_diagnostics(self, array: DiagnosticArray) -> None:
        if stamp_of(array) > self._since:
            self.diagnostics.append({value.key: value.value for value in array.status[0].values})

    def forget_replies(self) -> None:
        """Drop what has come so far, and what is still on its way: replies to samples that were sent until now."""
        self.drift, self.first_state, self._since = {}, 0.0, time.time_ns()
        self.diagnostics.clear()

    def hears_a_node(self) -> bool:
        """Return whether somebody takes both inputs."""
        return all(publisher.get_subscription_count() for publisher in (self._raw, self._temperature))

    def send_past(self) -> None:
        """Send the time before the start as fast as it goes, without loss."""
        for stamp, celsius, metres in past(self.start):
            self._send_temperature(stamp, celsius)
            self._executor.spin_once(timeout_sec=0.002)
            self._send_acceleration(stamp, metres)
            self._executor.spin_once(timeout_sec=0.002)

    def drive(self, seconds: float) -> None:
        """Send and listen for a time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            due = self.start + self._count * NANOSECONDS // RATE
            if (wait := due - time.time_ns()) > 0:
                self._executor.spin_once(timeout_sec=wait / NANOSECONDS)
                continue
            elapsed = (due - self.start) / NANOSECONDS
            if self._count % EVERY == 0:
                self._send_temperature(due, temperature(elapsed))
            self._send_acceleration(due, acceleration(elapsed))
            self._count += 1

    def begin(self) -> None:
        """Let real time begin now."""
        self._count = (time.time_ns() - self.start) * RATE // NANOSECONDS

    def _send_temperature(self, stamp: int, celsius: float) -> None:
        self._truth.add_temperature(stamp, celsius)
        message = Temperature(temperature=celsius)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NANOSECONDS)
        self._temperature.publish(message)

    def _send_acceleration(self, stamp: int, metres: float) -> None:
        self._truth.compensate(stamp, metres)
        message = Imu()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NANOSECONDS)
        message.linear_acceleration.z = metres
        self._raw.publish(message)

    def close(self) -> None:
        """Leave."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()
