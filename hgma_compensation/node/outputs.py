"""What the node publishes of samples: serialised messages, and states at a bounded rate."""

import struct
from collections.abc import Callable, Iterable

from builtin_interfaces.msg import Time
from rclpy.lifecycle import LifecyclePublisher
from std_msgs.msg import Header

from hgma_compensation.pipeline.live_result import LiveResult
from hgma_compensation.pipeline.state_fields import state_fields
from hgma_compensation.pipeline.state_rate import StateRate
from hgma_compensation.stamps import Stamps
from hgma_msgs.msg import CompensationState

_STAMP = struct.Struct("<iI")
_STAMP_AT = 4  # behind the encapsulation


def publish_all(publisher: LifecyclePublisher, raws: Iterable[bytes | bytearray]) -> None:
    """Publish serialised messages in their order, nothing where the node is not active."""
    if not publisher.is_activated:
        return
    # As rclpy's publish does for one of them, whose checks cost as much as the message.
    with publisher.handle:
        publish = publisher.handle.publish_raw
        for raw in raws:
            publish(raw)


def header_of(raw: bytes, frame: str) -> Header:
    """Return the header of a serialised message whose layout ``hgma_compensation.cdr`` recognises."""
    seconds, nanoseconds = _STAMP.unpack_from(raw, _STAMP_AT)
    return Header(stamp=Time(sec=seconds, nanosec=nanoseconds), frame_id=frame)


class States:
    """The state topic: one state for each of the samples that ``StateRate`` chooses."""

    def __init__(self, rate: float) -> None:
        """Choose at most ``rate`` a second besides those of change, 0 for all; the topic comes with ``open``."""
        self._rate = StateRate(rate)
        self._publisher: LifecyclePublisher | None = None

    def open(self, publisher: LifecyclePublisher | None) -> None:
        """Publish here from now on, None for nowhere."""
        self._publisher = publisher

    def reset(self) -> None:
        """Choose the next sample, whatever it is."""
        self._rate.reset()

    def rest(self, stamp: int) -> bool:
        """Return whether an ordinary sample at a stamp (ns) gets no state."""
        return self._rate.rests(stamp)

    def tell(self, stamps: Stamps, result: LiveResult, header: Callable[[int], Header]) -> None:
        """Take samples (n,) that got an output, in order; ``header`` returns that of the message of a row."""
        compensated = result.compensated
        if len(stamps) == 1:
            return self.tell_last(int(stamps[0]), result, header)
        rows = self._rate.choose(stamps, compensated.status, compensated.inside_range)
        for row in rows.tolist():
            self._publish(header(row), result, row)

    def tell_last(self, stamp: int, result: LiveResult, header: Callable[[int], Header]) -> None:
        """Take the samples of one message, for which the last one stands, at ``stamp`` (ns)."""
        compensated, status, inside = result.compensated, 0, True
        if not compensated.ordinary:
            status, inside = int(compensated.status[-1]), bool(compensated.inside_range[-1])
        if self._rate.wants(stamp, status, inside):
            self._publish(header(0), result, -1)

    def _publish(self, header: Header, result: LiveResult, row: int) -> None:
        assert self._publisher is not None
        fields = state_fields(result.calibration, result.compensated, row)
        self._publisher.publish(CompensationState(header=header, **fields))
