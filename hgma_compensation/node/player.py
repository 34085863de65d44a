"""Publishes a recording to ROS, as ``ros2 bag play`` does where that is installed."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import rclpy
from builtin_interfaces.msg import Time
from rclpy.duration import Duration
from rclpy.node import Node
from rosbags.interfaces import Connection
from rosgraph_msgs.msg import Clock

from hgma_compensation import topics
from hgma_compensation.errors import RefusedError
from hgma_compensation.node.interfaces import SETTLING, output_qos
from hgma_compensation.node.message_types import message_class
from hgma_compensation.progress import Advance, counted
from hgma_compensation.recording.bag_reader import open_bag, read_messages
from hgma_compensation.stamps import NANOSECONDS

ACKNOWLEDGED = 5.0
"""s to wait at the end until reliable readers have everything."""

CLOCK_PERIOD = 0.01
"""s of wall time between two messages on /clock."""


@dataclass(frozen=True)
class PlayOptions:
    """rate: of bag time to wall time. wait: s to wait for a subscriber of the accelerometer's topic.

    names: the bag's topics; those of the node are published under the node's names.
    """

    rate: float = 1.0
    loop: bool = False
    clock: bool = False
    wait: float = 0.0
    names: topics.TopicNames = field(default_factory=topics.TopicNames)


class Player:
    """One bag on its way to ROS."""

    def __init__(self, node: Node, path: Path, options: PlayOptions, progress: Advance | None = None) -> None:
        """Publish from a node of the caller's."""
        self._node, self._path, self._options, self._progress = node, Path(path), options, progress
        self._published = {options.names[topic]: topic for topic in topics.INPUTS}
        self._clock = node.create_publisher(Clock, "/clock", 10) if options.clock else None
        self._clock_sent = 0.0

    def play(self) -> int:
        """Publish all messages, again and again with ``loop``, and return how many were sent."""
        with open_bag(self._path) as reader:
            connections = [c for c in reader.connections if c.msgcount]
            publishers = {c.id: self._publisher(c) for c in connections}
            if not any(publishers.values()):
                raise RefusedError(f"bag {self._path} holds no topic of a message type that is installed here")
            self._wait([p for p in publishers.values() if p is not None])
            count = 0
            while rclpy.ok():
                messages = self._paced(read_messages(reader, self._path, connections), publishers)
                for publisher, raw in counted(messages, self._progress, every=100):
                    publisher.publish(raw)
                    count += 1
                if not self._options.loop:
                    break
            for publisher in filter(None, publishers.values()):
                publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGED))
            # Best-effort readers acknowledge nothing, and may drop what they hold of a writer that is gone.
            time.sleep(SETTLING)
            return count

    def _publisher(self, connection: Connection) -> Any:
        try:
            message_type = message_class(connection.msgtype)
        except (ValueError, AttributeError, ModuleNotFoundError):
            self._node.get_logger().warning(f"{connection.topic} is not played: {connection.msgtype} is not installed")
            return None
        topic = self._published.get(connection.topic, connection.topic)
        return self._node.create_publisher(message_type, topic, output_qos(topic))

    def _wait(self, publishers: Sequence[Any]) -> None:
        """Wait until every topic of the node that is played has a subscriber, at most ``wait`` s."""
        wanted = [p for p in publishers if p.topic_name.lstrip("/") in topics.INPUTS]
        end = time.monotonic() + self._options.wait
        while time.monotonic() < end and not all(p.get_subscription_count() for p in wanted):
            time.sleep(0.02)
        # We know of the subscriber before it knows of us, and until then it takes nothing that is best effort.
        time.sleep(min(SETTLING, self._options.wait))

    def _paced(
        self, messages: Iterator[tuple[Connection, int, bytes]], publishers: dict[int, Any]
    ) -> Iterator[tuple[Any, bytes]]:
        """Yield each message when its time has come."""
        origin: int | None = None
        start = time.monotonic()
        for connection, stamp, raw in messages:
            if not rclpy.ok():
                return
            origin = stamp if origin is None else origin
            due = start + (stamp - origin) / NANOSECONDS / self._options.rate
            self._sleep_until(due, stamp)
            publisher = publishers[connection.id]
            if publisher is not None:
                yield publisher, bytes(raw)

    def _sleep_until(self, due: float, stamp: int) -> None:
        """Sleep until a moment of the monotonic clock; /clock goes on meanwhile and ends at the stamp."""
        while (left := due - time.monotonic()) > 0.0 and rclpy.ok():
            time.sleep(min(left, CLOCK_PERIOD))
            self._tell_time(stamp - round(max(due - time.monotonic(), 0.0) * self._options.rate * NANOSECONDS))
        self._tell_time(stamp)

    def _tell_time(self, now: int) -> None:
        if self._clock is not None and time.monotonic() - self._clock_sent >= CLOCK_PERIOD:
            self._clock_sent = time.monotonic()
            self._clock.publish(Clock(clock=Time(sec=now // NANOSECONDS, nanosec=now % NANOSECONDS)))
