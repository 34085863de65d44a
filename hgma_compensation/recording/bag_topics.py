"""The topics of a bag that the node knows, found under the names that they have there."""

from pathlib import Path

from rosbags.interfaces import Connection

from hgma_compensation import topics
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.slow_inputs import SLOW_INPUTS, SlowInput


class BagTopics:
    """Accelerometer and slow inputs of an open bag; those without messages are none.

    blocks: whether the accelerometer comes in AccelBlocks. slow: each slow input with its connections.
    """

    def __init__(self, bag: Bag, path: Path, names: topics.TopicNames) -> None:
        """Find them.

        Accelerations come from the message topic, or from the block topic where there are no messages. Raises
        RefusedError where there is neither, or where a topic has another type.
        """
        self._bag, self._path = bag, path
        imu = self._connections(names[topics.RAW], types.IMU)
        blocks = [] if imu else self._connections(names[topics.RAW_BLOCK], types.ACCEL_BLOCK)
        if not imu and not blocks:
            held = ", ".join(sorted({connection.topic for connection in bag.connections})) or "nothing"
            raise RefusedError(
                f"bag {path} holds no {names[topics.RAW]}, only {held}: "
                f"name the accelerometer's topic with --remap /{topics.RAW}:=/your/topic"
            )
        self.blocks, self.accelerometer = bool(blocks), imu or blocks
        self.slow: list[tuple[SlowInput, list[Connection]]] = [
            (slow, self._connections(names[slow.topic], slow.message_type)) for slow in SLOW_INPUTS
        ]

    def _connections(self, topic: str, message_type: str) -> list[Connection]:
        found = [connection for connection in self._bag.connections if connection.topic == topic]
        for connection in found:
            if connection.msgtype != message_type:
                raise RefusedError(
                    f"bag {self._path}: {topic} is a {connection.msgtype}, must be {message_type}: "
                    "name the right topic with --remap"
                )
        return found if any(connection.msgcount for connection in found) else []

    @property
    def read(self) -> list[Connection]:
        """The connections of all of them, each once."""
        every = [*self.accelerometer, *(connection for _, connections in self.slow for connection in connections)]
        return list({connection.id: connection for connection in every}.values())
