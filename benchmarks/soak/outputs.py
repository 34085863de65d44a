"""Every output of a node that compensates the samples of ``imu_source``, and what is wrong with them."""

from array import array
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from sensor_msgs.msg import Imu

from benchmarks.soak.serialised import NUMBER, acceleration_at, drift_at, orientation_at, stamp_of
from hgma_compensation import topics
from hgma_msgs.msg import CompensationState

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=20_000, reliability=ReliabilityPolicy.RELIABLE)
ID_PREFIX, ID_LENGTH = b"sha256-", 23
FRAME = "imu_link"


@dataclass(frozen=True)
class Request:
    """A request to load a file: ns at which it was sent and answered, and the calibration in use after it."""

    sent: int
    answered: int
    in_use: int


class Outputs:
    """Reads both topics of outputs without an executor, as serialised bytes; calibrations are told by their number."""

    def __init__(self, node: Node, ids: Sequence[str], channels: Sequence[str]) -> None:
        """Subscribe with a node that nobody spins."""
        self._compensated = node.create_subscription(Imu, topics.COMPENSATED, _ignore, QOS, raw=True)
        self._states = node.create_subscription(CompensationState, topics.STATE, _ignore, QOS, raw=True)
        self._numbers = {calibration_id.encode(): number for number, calibration_id in enumerate(ids)}
        self._number, self._x = orientation_at(FRAME), acceleration_at(FRAME)
        self._drift = drift_at(FRAME, list(channels))
        self.x, self.number, self.drift = array("d"), array("d"), array("d")
        self.stamp, self.published = array("q"), array("q")
        self.state_stamp, self.calibration = array("q"), array("q")

    def drain(self) -> None:
        """Take all outputs that have come."""
        while (taken := _take(self._compensated)) is not None:
            raw, published = taken
            self.x.append(NUMBER.unpack_from(raw, self._x)[0])
            self.number.append(NUMBER.unpack_from(raw, self._number)[0])
            self.stamp.append(stamp_of(raw))
            self.published.append(published)
        while (taken := _take(self._states)) is not None:
            raw, _ = taken
            begin = raw.rindex(ID_PREFIX)
            self.calibration.append(self._numbers[raw[begin : begin + ID_LENGTH]])
            self.drift.append(NUMBER.unpack_from(raw, self._drift)[0])
            self.state_stamp.append(stamp_of(raw))

    def faults(self, sent: int, offsets: Sequence[float], requests: Sequence[Request]) -> dict[str, int]:
        """Return how many outputs are at fault, by the kind of fault.

        sent: number of samples. offsets: what each calibration subtracts.
        """
        count = min(len(self.x), len(self.calibration))
        number, calibration = np.array(self.number)[:count], np.array(self.calibration)[:count]
        published = np.array(self.published)[:count]
        offset = np.array(offsets)[calibration]
        wrong = (np.array(self.x)[:count] != number - offset) | (np.array(self.drift)[:count] != offset)
        changes = int(np.count_nonzero(np.diff(calibration)))
        wanted = int(np.count_nonzero(np.diff([0, *(request.in_use for request in requests)])))
        return {
            "lost": sent - len(np.unique(number)),
            "twice": len(self.x) - len(np.unique(np.array(self.number))),
            "out_of_order": int(np.count_nonzero(np.diff(number) <= 0.0)),
            "without_state": len(self.x) - len(self.calibration),
            "other_state": int(np.count_nonzero(np.array(self.stamp)[:count] != np.array(self.state_stamp)[:count])),
            "mixed": int(np.count_nonzero(wrong)),
            "at_the_wrong_time": int(np.count_nonzero(~_allowed(calibration, published, requests))),
            "changed_back": max(changes - wanted, 0),
        }


def _allowed(
    calibration: NDArray[np.int64], published: NDArray[np.int64], requests: Sequence[Request]
) -> NDArray[np.bool_]:
    """Return whether each output (n,) may belong to its calibration, by the time (ns) at which it was published.

    Between two requests that is the one in use; while one is answered, that before it or that after it.
    """
    sent, answered, in_use = (
        np.array([first, *(getattr(request, name) for request in requests)])
        for name, first in (("sent", 0), ("answered", 0), ("in_use", 0))
    )
    last = np.searchsorted(sent, published, side="right") - 1
    before = in_use[np.maximum(last - 1, 0)]
    return np.asarray((calibration == in_use[last]) | ((published <= answered[last]) & (calibration == before)))


def _take(subscription: Subscription) -> tuple[bytes, int] | None:
    with subscription.handle:
        taken = subscription.handle.take_message(subscription.msg_type, True)
    return None if taken is None else (taken[0], taken[1]["source_timestamp"])


def _ignore(_: bytes) -> None:
    """Stand in for a callback that an executor would call."""
