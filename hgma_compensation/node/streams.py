"""The node's sample topics: raw messages in, compensated messages and states out."""

from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.lifecycle import LifecycleNode
from sensor_msgs.msg import Imu, Temperature
from std_msgs.msg import Header

from hgma_compensation import topics
from hgma_compensation.errors import RefusedError
from hgma_compensation.messages import (
    block_samples,
    imu_values,
    patch_block,
    patch_imu,
    stamp_of,
    widen_block,
)
from hgma_compensation.node.interfaces import INPUT_QOS, OUTPUT_QOS, drain, overridable
from hgma_compensation.pipeline.live import LiveCompensation, LiveResult, single_sample
from hgma_compensation.pipeline.reasons import Skip
from hgma_compensation.pipeline.state_fields import state_fields
from hgma_msgs.msg import AccelBlock, CompensationState, SupplyVoltage


class Streams:
    """Subscriptions and publishers between ``open`` and ``close``; what comes is given to a LiveCompensation.

    publishing: whether samples get an output; the slow inputs are followed in any case.
    """

    def __init__(self, node: LifecycleNode, live: LiveCompensation) -> None:
        """Take the node that owns the topics, which are not open yet."""
        self._node, self._live = node, live
        self.publishing = False
        self._slow: list[tuple[Any, Callable[[Any], None]]] = []
        self._fast: list[tuple[Any, Callable[[Any], None]]] = []
        self._publishers: list[Any] = []

    def open(self) -> None:
        """Create subscriptions and publishers."""
        subscribe = partial(self._node.create_subscription, qos_profile=INPUT_QOS, qos_overriding_options=overridable())
        publish = partial(
            self._node.create_lifecycle_publisher, qos_profile=OUTPUT_QOS, qos_overriding_options=overridable()
        )
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
        self._publishers = [self._compensated, self._compensated_block, self._states]

    def close(self) -> None:
        """Destroy what ``open`` created; nothing where it is closed."""
        for subscription, _ in (*self._slow, *self._fast):
            self._node.destroy_subscription(subscription)
        for publisher in self._publishers:
            self._node.destroy_lifecycle_publisher(publisher)
        self._slow, self._fast, self._publishers = [], [], []

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

    def serve(self) -> None:
        """Compensate what waits; for a callback that keeps the executor from calling those of the topics."""
        waiting = [(list(drain(subscription)), take) for subscription, take in self._fast]
        self._drain_slow()
        for messages, take in waiting:
            for message in messages:
                take(message)

    def _on_raw(self, message: Imu) -> None:
        waiting = [message, *drain(self._raw)]
        self._drain_slow()
        for taken in waiting:
            self._compensate(taken)

    def _compensate(self, message: Imu) -> None:
        if not self.publishing:
            return self._live.skip_unseen(Skip.NOT_ACTIVE, 1)
        result = self._live.compensate(*single_sample(stamp_of(message), imu_values(message)))
        if result is not None:
            patch_imu(message, result.calibration.names, result.compensated.values[0].tolist())
            self._compensated.publish(message)
            self._publish_state(message.header, result)

    def _on_raw_block(self, message: AccelBlock) -> None:
        self._drain_slow()
        self._compensate_block(message)

    def _compensate_block(self, message: AccelBlock) -> None:
        if not self.publishing:
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
