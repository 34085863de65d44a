"""The other end of both topics, source and sink in one thread: serialised bytes out, serialised bytes in."""

import time
from typing import Any

import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from sensor_msgs.msg import Temperature

from hgma_compensation import topics
from hgma_compensation.stamps import NANOSECONDS

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=50_000, reliability=ReliabilityPolicy.RELIABLE)
"""Deep, so that nothing is lost on this side; reliable, which readers of either kind hear."""

CELSIUS = 25.0


class Peer:
    """Publishes to one topic and hears another, without an executor, whose cost would be the rival's and ours."""

    def __init__(self, message_type: Any, source: str, sink: str) -> None:
        """Join the ROS domain of the environment."""
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context)
        self._node = rclpy.create_node("peer", context=self._context)
        self._publisher = self._node.create_publisher(message_type, source, QOS)
        self._thermistor = self._node.create_publisher(Temperature, topics.TEMPERATURE, QOS)
        self._subscription = self._node.create_subscription(message_type, sink, _ignore, QOS, raw=True)
        self._wait_set = _rclpy.WaitSet(1, 0, 0, 0, 0, 0, self._context.handle)
        self._type, self._sink = message_type, sink

    def found(self) -> bool:
        """Return whether somebody takes what is sent, and sends to the sink."""
        return bool(self._publisher.get_subscription_count() and self._node.count_publishers(self._sink))

    def send(self, message: bytes) -> None:
        """Publish a message."""
        self._publisher.publish(message)

    def send_temperature(self, stamp: int) -> None:
        """Publish a thermistor sample, stamped in ns."""
        message = Temperature(temperature=CELSIUS)
        message.header.frame_id = "imu_link"
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NANOSECONDS)
        self._thermistor.publish(serialize_message(message))

    def take(self, into: list[bytes]) -> None:
        """Append the messages that have come."""
        handle = self._subscription.handle
        with handle:
            while (taken := handle.take_message(self._type, True)) is not None:
                into.append(taken[0])

    def wait(self, seconds: float) -> None:
        """Wait until a message has come, or for a time."""
        with self._subscription.handle:
            self._wait_set.clear_entities()
            self._wait_set.add_subscription(self._subscription.handle)
            self._wait_set.wait(max(round(seconds * NANOSECONDS), 0))

    def forget(self, silence: float = 0.2) -> None:
        """Drop what still comes of earlier messages, until none has come for a time, s."""
        left: list[bytes] = []
        quiet_since = time.perf_counter()
        while time.perf_counter() - quiet_since < silence:
            time.sleep(0.01)
            self.take(left)
            if left:
                left.clear()
                quiet_since = time.perf_counter()

    def close(self) -> None:
        """Leave."""
        self._wait_set.clear_entities()
        self._node.destroy_node()
        self._context.try_shutdown()


def _ignore(_: bytes) -> None:
    """Stand in for a callback that an executor would call."""
