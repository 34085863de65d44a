"""The node's sample topics: raw messages in, compensated messages and states out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.lifecycle import LifecycleNode
from sensor_msgs.msg import Imu, Temperature

from hgma_compensation import topics
from hgma_compensation.messages import stamp_of
from hgma_compensation.node.admission import Admission
from hgma_compensation.node.block_stream import BlockStream
from hgma_compensation.node.endpoints import Endpoints
from hgma_compensation.node.imu_stream import ImuStream
from hgma_compensation.node.latency import Latency
from hgma_compensation.node.losses import CountedInput
from hgma_compensation.node.outputs import States
from hgma_compensation.node.unreadable import read
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.transport import unreadable_name
from hgma_msgs.msg import AccelBlock, CompensationState, SupplyVoltage

MOST_SAMPLES = 500
"""Messages of a sample each that are compensated before others have their turn: some ms."""

MOST_BLOCKS = 8
MOST_SLOW = 1000


@dataclass(frozen=True)
class _Slow:
    """A slow input, and what takes the stamp (ns) and the value of its messages."""

    topic: str
    counted: CountedInput
    message_type: type
    field: str
    add: Callable[[int, float], None]


class Streams:
    """Subscriptions and publishers between ``open`` and ``close``; what comes is given to a LiveCompensation.

    The slow inputs are followed whether samples get an output or not.
    """

    def __init__(self, node: LifecycleNode, live: LiveCompensation, *, frame_id: str, state_rate: float) -> None:
        """Take the node that owns the topics, which are not open yet.

        frame_id: the one that messages of the accelerometer must have, "" for any. state_rate: states a second, 0 for
        one with every sample.
        """
        self._live = live
        self.states = States(state_rate)
        self._admission = Admission(live, frame_id, self.states.reset)
        self.endpoints = Endpoints(node, live.counts)
        self.latency = Latency(node)
        self._slow: list[_Slow] = []
        self._fast: list[tuple[CountedInput, int, Callable[[Sequence[bytes]], int | None]]] = []

    @property
    def publishing(self) -> bool:
        """Whether samples get an output."""
        return self._admission.publishing

    @publishing.setter
    def publishing(self, publishing: bool) -> None:
        self._admission.publishing = publishing
        self.states.reset()

    def open(self) -> None:
        """Create subscriptions and publishers."""
        subscribe, publish = self.endpoints.subscribe, self.endpoints.publish
        slow: Sequence[tuple[str, Any, str, Callable[[int, float], None]]] = (
            (topics.TEMPERATURE, Temperature, "temperature", self._live.add_temperature),
            (topics.TEMPERATURE_2, Temperature, "temperature", self._live.add_temperature_2),
            (topics.SUPPLY_VOLTAGE, SupplyVoltage, "voltage", self._live.add_supply_voltage),
        )
        self._slow = [_Slow(topic, subscribe(kind, topic), kind, field, add) for topic, kind, field, add in slow]
        raw, blocks = subscribe(Imu, topics.RAW), subscribe(AccelBlock, topics.RAW_BLOCK)
        compensated = publish(Imu, topics.COMPENSATED)
        compensated_blocks = publish(AccelBlock, topics.COMPENSATED_BLOCK)
        self.states.open(publish(CompensationState, topics.STATE))
        parts = (self._live, self._admission)
        self._fast = [
            (raw, MOST_SAMPLES, ImuStream(*parts, compensated, self.states).take),
            (blocks, MOST_BLOCKS, BlockStream(*parts, compensated_blocks, self.states).take),
        ]

    def close(self) -> None:
        """Destroy what ``open`` created; nothing where it is closed."""
        self.endpoints.close()
        self.states.open(None)
        self._slow, self._fast = [], []

    def serve(self) -> None:
        """Compensate what waits.

        Slow samples are taken after accelerations were taken and before they are compensated: a slow sample that was
        sent before one of them is then among those taken here.
        """
        self.latency.begin()
        waiting = [(counted.take(most), take) for counted, most, take in self._fast]
        for slow in self._slow:
            self._take_slow(slow)
        for raws, take in waiting:
            stamp = take(raws) if raws else None
            if stamp is not None:
                self.latency.end(stamp)

    def _take_slow(self, slow: _Slow) -> None:
        for raw in slow.counted.take(MOST_SLOW):
            message = read(raw, slow.message_type)
            if message is None:
                self._live.counts[unreadable_name(slow.topic)] += 1
            else:
                slow.add(stamp_of(message), getattr(message, slow.field))
