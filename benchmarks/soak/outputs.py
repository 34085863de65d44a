"""Every output of a node that compensates the samples of ``imu_source``."""

from collections.abc import Sequence

from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from sensor_msgs.msg import Imu

from benchmarks.soak.reload_account import Recorded
from benchmarks.soak.serialised import NUMBER, acceleration_at, drift_at, orientation_at, stamp_of
from hgma_compensation import topics
from hgma_msgs.msg import CompensationState

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=20_000, reliability=ReliabilityPolicy.RELIABLE)
ID_PREFIX, ID_LENGTH = b"sha256-", 23
FRAME = "imu_link"


class Outputs:
    """Reads both topics of outputs without an executor, as serialised bytes; calibrations are told by their number."""

    def __init__(self, node: Node, ids: Sequence[str], channels: Sequence[str]) -> None:
        """Subscribe with a node that nobody spins."""
        self._compensated = node.create_subscription(Imu, topics.COMPENSATED, _ignore, QOS, raw=True)
        self._states = node.create_subscription(CompensationState, topics.STATE, _ignore, QOS, raw=True)
        self._numbers = {calibration_id.encode(): number for number, calibration_id in enumerate(ids)}
        self._number, self._x = orientation_at(FRAME), acceleration_at(FRAME)
        self._drift = drift_at(FRAME, list(channels))
        self.recorded = Recorded()

    def drain(self) -> None:
        """Take all outputs that have come."""
        recorded = self.recorded
        while (taken := _take(self._compensated)) is not None:
            raw, published = taken
            recorded.x.append(NUMBER.unpack_from(raw, self._x)[0])
            recorded.number.append(NUMBER.unpack_from(raw, self._number)[0])
            recorded.stamp.append(stamp_of(raw))
            recorded.published.append(published)
        while (taken := _take(self._states)) is not None:
            raw, _ = taken
            begin = raw.rindex(ID_PREFIX)
            recorded.calibration.append(self._numbers[raw[begin : begin + ID_LENGTH]])
            recorded.drift.append(NUMBER.unpack_from(raw, self._drift)[0])
            recorded.state_stamp.append(stamp_of(raw))


def _take(subscription: Subscription) -> tuple[bytes, int] | None:
    with subscription.handle:
        taken = subscription.handle.take_message(subscription.msg_type, True)
    return None if taken is None else (taken[0], taken[1]["source_timestamp"])


def _ignore(_: bytes) -> None:
    """Stand in for a callback that an executor would call."""
