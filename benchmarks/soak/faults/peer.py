"""The other end of the node: sends the stream, takes every output, keeps the account."""

import time
from collections import deque
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.srv import ChangeState
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, Temperature
from std_srvs.srv import Trigger

from benchmarks.soak.faults.segment import Block, Item, Sample, Slow
from hgma_compensation import topics
from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import AccelBlock, CompensationState, SupplyVoltage
from hgma_msgs.srv import LoadCalibration

NODE = "/compensation_node"
QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=20_000, reliability=ReliabilityPolicy.RELIABLE)
ANSWERED = 30.0
"""s after which a request, or the end of the stream, counts as unanswered."""

NUMBERS_OF_STATE = ("temperature", "temperature_rate", "temperature_product")


class Peer:
    """sent: samples so far. outputs: samples that came back. wrong: what should never be seen, by name."""

    def __init__(self, domain: int, calibrations: list[Path], refused: Path) -> None:
        """Connect to the node, which runs already, with calibrations to swap and one that is refused."""
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = rclpy.create_node("soak_peer", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        publish = {topics.RAW: Imu, topics.RAW_BLOCK: AccelBlock, topics.SUPPLY_VOLTAGE: SupplyVoltage}
        publish |= {topics.TEMPERATURE: Temperature, topics.TEMPERATURE_2: Temperature}
        self._publishers = {topic: self._node.create_publisher(kind, topic, QOS) for topic, kind in publish.items()}
        for kind, topic, take in (
            (Imu, topics.COMPENSATED, self._on_compensated),
            (AccelBlock, topics.COMPENSATED_BLOCK, self._on_block),
            (CompensationState, topics.STATE, self._on_state),
            (DiagnosticArray, "/diagnostics", self._on_diagnostics),
        ):
            self._node.create_subscription(kind, topic, take, QOS)
        self._calibrations, self._refused = deque(calibrations), refused
        self._awaited: deque[tuple[int, int]] = deque()
        self._awaited_blocks: deque[tuple[int, int]] = deque()
        self.sent = self.outputs = self.states = 0
        self.wrong: dict[str, int] = {}
        self.diagnostics: dict[str, str] = {}
        self._reports = 0

    def connect(self) -> None:
        """Wait until the node hears all inputs."""
        while not all(publisher.get_subscription_count() for publisher in self._publishers.values()):
            self.spin(0.05)
        self.spin(1.0)

    def spin(self, seconds: float) -> None:
        """Take outputs for a while, at least all that wait."""
        end = time.monotonic() + seconds
        while True:
            self._executor.spin_once(timeout_sec=max(end - time.monotonic(), 0.0))
            if time.monotonic() >= end:
                return

    def send(self, item: Item) -> None:
        """Publish a message, or do an action and wait until it is done."""
        if isinstance(item, Sample):
            self._publishers[topics.RAW].publish(_imu(item))
            self._awaited.append((item.number, item.stamp))
            self.sent += 1
        elif isinstance(item, Block):
            self._publishers[topics.RAW_BLOCK].publish(_block(item))
            self._awaited_blocks.append((item.stamp, len(item.axes[0])))
            self.sent += len(item.axes[0])
        elif isinstance(item, Slow):
            self._publishers[item.topic].publish(_slow(item))
        else:
            getattr(self, f"_{item.name}")()

    def settle(self) -> bool:
        """Wait until the node has received all that was sent; return whether it has, and all its outputs came."""
        end = time.monotonic() + ANSWERED
        while time.monotonic() < end:
            seen = self._reports
            while self._reports == seen and time.monotonic() < end:
                self.spin(0.05)
            received, compensated = (int(self.diagnostics[f"samples_{name}"]) for name in ("received", "compensated"))
            if received == self.sent and compensated == self.outputs:
                return True
        return False

    def close(self) -> None:
        """Leave ROS."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    # Actions ----------------------------------------------------------------------------------------

    def _swap(self) -> None:
        self._calibrations.rotate()
        self._expect(self._load(self._calibrations[0]).success, "good calibration refused")

    def _refuse(self) -> None:
        answer = self._load(self._refused)
        self._expect(
            not answer.success and answer.calibration_id == answer.previous_calibration_id, "bad file accepted"
        )

    def _reset(self) -> None:
        self._expect(self._call(Trigger, f"{NODE}/reset", Trigger.Request()).success, "reset failed")

    def _deactivate(self) -> None:
        self._change("deactivate")

    def _activate(self) -> None:
        self._change("activate")

    def _change(self, transition: str) -> None:
        # What was sent before is to be judged in the state that it was sent in.
        self._expect(self.settle(), f"unsettled before {transition}")
        request = ChangeState.Request()
        request.transition.label = transition
        self._expect(self._call(ChangeState, f"{NODE}/change_state", request).success, f"{transition} failed")

    def _load(self, path: Path) -> Any:
        return self._call(LoadCalibration, f"{NODE}/load_calibration", LoadCalibration.Request(path=str(path)))

    def _call(self, kind: Any, name: str, request: Any) -> Any:
        client = self._node.create_client(kind, name)
        while not client.service_is_ready():
            self.spin(0.01)
        future = client.call_async(request)
        end = time.monotonic() + ANSWERED
        while not future.done():
            if time.monotonic() > end:
                raise RuntimeError(f"{name} did not answer within {ANSWERED:g} s")
            self.spin(0.002)
        self._node.destroy_client(client)
        return future.result()

    # Outputs ----------------------------------------------------------------------------------------

    def _expect(self, right: bool, otherwise: str) -> None:
        if not right:
            self.wrong[otherwise] = self.wrong.get(otherwise, 0) + 1

    def _on_compensated(self, message: Imu) -> None:
        self.outputs += 1
        expected = (round(message.orientation.x), _stamp_of(message))
        while self._awaited and self._awaited[0][0] < expected[0]:
            self._awaited.popleft()
        self._expect(bool(self._awaited) and self._awaited.popleft() == expected, "output without its input")
        a = message.linear_acceleration
        self._expect(all(map(isfinite, (a.x, a.y, a.z, *message.linear_acceleration_covariance))), "not finite")

    def _on_block(self, message: AccelBlock) -> None:
        self.outputs += len(message.x)
        expected = (_stamp_of(message), len(message.x))
        while self._awaited_blocks and self._awaited_blocks[0] != expected:
            self._awaited_blocks.popleft()
        self._expect(bool(self._awaited_blocks), "output without its input")
        if self._awaited_blocks:
            self._awaited_blocks.popleft()
        self._expect(bool(np.isfinite([message.x, message.y, message.z]).all()), "not finite")

    def _on_state(self, message: CompensationState) -> None:
        self.states += 1
        numbers = [getattr(message, name) for name in NUMBERS_OF_STATE]
        numbers += [*message.drift, *message.innovation, *message.uncertainty]
        self._expect(all(map(isfinite, numbers)), "state not finite")

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        self._reports += 1
        self.diagnostics = {value.key: value.value for value in message.status[0].values}


def _stamp_of(message: Any) -> int:
    return int(message.header.stamp.sec) * NANOSECONDS + int(message.header.stamp.nanosec)


def _stamped(message: Any, stamp: int, frame: str) -> Any:
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NANOSECONDS)
    message.header.frame_id = frame
    return message


def _imu(sample: Sample) -> Any:
    message = _stamped(Imu(), sample.stamp, sample.frame)
    a = message.linear_acceleration
    a.x, a.y, a.z = sample.values[:3]
    message.linear_acceleration_covariance = np.array(sample.covariance)
    message.orientation.x = float(sample.number)
    return message


def _block(block: Block) -> Any:
    x, y, z = block.axes
    return _stamped(AccelBlock(sample_interval=block.interval, x=x, y=y, z=z), block.stamp, block.frame)


def _slow(sample: Slow) -> Any:
    if sample.topic == topics.SUPPLY_VOLTAGE:
        return _stamped(SupplyVoltage(voltage=sample.value), sample.stamp, "imu_link")
    return _stamped(Temperature(temperature=sample.value), sample.stamp, "imu_link")
