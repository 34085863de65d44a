"""The node's sample topics: raw messages in, compensated messages and states out."""

from collections.abc import Callable
from typing import Any

from rclpy.lifecycle import LifecycleNode
from sensor_msgs.msg import Imu, Temperature
from std_msgs.msg import Header

from hgma_compensation import topics
from hgma_compensation.errors import RefusedError
from hgma_compensation.messages import (
    absent_groups,
    block_samples,
    imu_values,
    patch_block,
    patch_covariances,
    patch_imu,
    stamp_of,
    widen_block,
)
from hgma_compensation.node.endpoints import Endpoints
from hgma_compensation.node.latency import Latency
from hgma_compensation.node.losses import CountedInput
from hgma_compensation.pipeline.live import LiveCompensation, LiveResult, single_sample
from hgma_compensation.pipeline.reasons import Note, Skip
from hgma_compensation.pipeline.state_fields import state_fields
from hgma_msgs.msg import AccelBlock, CompensationState, SupplyVoltage


class Streams:
    """Subscriptions and publishers between ``open`` and ``close``; what comes is given to a LiveCompensation.

    publishing: whether samples get an output; the slow inputs are followed in any case.
    """

    def __init__(self, node: LifecycleNode, live: LiveCompensation, *, frame_id: str) -> None:
        """Take the node that owns the topics, which are not open yet.

        frame_id: the one that messages of the accelerometer must have, "" for any.
        """
        self._live = live
        self.publishing, self._wanted_frame = False, frame_id
        self._frame: str | None = None
        self.endpoints = Endpoints(node, live.counts)
        self.latency = Latency(node)
        self._slow: list[tuple[CountedInput, Callable[[Any], None]]] = []
        self._fast: list[tuple[CountedInput, Callable[[Any], None]]] = []

    def open(self) -> None:
        """Create subscriptions and publishers."""
        subscribe, publish = self.endpoints.subscribe, self.endpoints.publish
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
        blocks = subscribe(AccelBlock, topics.RAW_BLOCK, self._on_raw_block)
        self._fast = [(self._raw, self._compensate), (blocks, self._compensate_block)]
        self._compensated = publish(Imu, topics.COMPENSATED)
        self._compensated_block = publish(AccelBlock, topics.COMPENSATED_BLOCK)
        self._states = publish(CompensationState, topics.STATE)

    def close(self) -> None:
        """Destroy what ``open`` created; nothing where it is closed."""
        self.endpoints.close()
        self._slow, self._fast = [], []

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
        for counted, take in self._slow:
            for message in counted.drain():
                take(message)

    def serve(self) -> None:
        """Compensate what waits; for a callback that keeps the executor from calling those of the topics."""
        self.latency.begin()
        waiting = [(list(counted.drain()), take) for counted, take in self._fast]
        self._drain_slow()
        for messages, take in waiting:
            for message in messages:
                take(message)
                self.latency.end(stamp_of(message))

    def _on_raw(self, message: Imu) -> None:
        self.latency.begin()
        waiting = [message, *self._raw.drain()]
        self._drain_slow()
        for taken in waiting:
            self._compensate(taken)
        self.latency.end(stamp_of(waiting[-1]))

    def _compensate(self, message: Imu) -> None:
        reason = self._reason_to_skip(message.header)
        if reason is None and self._live.covers(absent_groups(message)):
            reason = Skip.ABSENT
        if reason is not None:
            return self._live.skip_unseen(reason, 1)
        result = self._live.compensate(*single_sample(stamp_of(message), imu_values(message)))
        if result is not None:
            names = result.calibration.names
            patch_imu(message, names, result.compensated.values[0].tolist())
            if not patch_covariances(message, names, result.compensated.added_variance(0)):
                self._live.note(Note.COVARIANCE_INVALID)
            self._compensated.publish(message)
            self._publish_state(message.header, result)

    def _reason_to_skip(self, header: Header) -> Skip | None:
        """Return why a message is not even looked at, None where it is."""
        if not self.publishing:
            return Skip.NOT_ACTIVE
        if header.frame_id != self._frame:
            if self._wanted_frame not in ("", header.frame_id):
                return Skip.OTHER_FRAME
            self._frame = header.frame_id
            self._live.begin_frame(header.frame_id)
        return None

    def _on_raw_block(self, message: AccelBlock) -> None:
        self.latency.begin()
        self._drain_slow()
        self._compensate_block(message)
        self.latency.end(stamp_of(message))

    def _compensate_block(self, message: AccelBlock) -> None:
        reason = self._reason_to_skip(message.header)
        if reason is not None:
            return self._live.skip_unseen(reason, len(message.x))
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
