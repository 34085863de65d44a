"""Messages that were sent and never arrived, seen by the gaps in their publishers' numbering."""

from collections import Counter
from collections.abc import Callable
from typing import TypedDict

from rclpy.subscription import Subscription

from hgma_compensation.pipeline.transport import lost_name


class MessageInfo(TypedDict):
    """What rclpy tells of a message; the number is None where the RMW gives none (Fast DDS does)."""

    publication_sequence_number: int | None


class SequenceGaps:
    """Follows the numbers of one or more publishers of a topic, of which only the number itself is known."""

    def __init__(self) -> None:
        """Start with no number: what was sent before the first one is not missed."""
        self._last: list[int] = []

    def add(self, number: int, publishers: Callable[[], int]) -> int:
        """Take the number of a message and return how many of its publisher's are missing before it.

        publishers: how many there are now; asked only where the number is not the expected one. So many sequences are
        told apart, those that were heard last. A number that continues none of them belongs to a publisher not heard
        before, if there can be one, or else to the nearest sequence below it. A number below all of them is that of a
        publisher that has begun anew.
        """
        if self._last and number == self._last[0] + 1:
            self._last[0] = number
            return 0
        most = max(publishers(), 1)
        nearest = max((last for last in self._last if last < number), default=None)
        if nearest is None or (nearest != number - 1 and len(self._last) < most):
            nearest = number - 1
        else:
            self._last.remove(nearest)
        self._last = [number, *self._last][:most]
        return number - nearest - 1


class CountedInput:
    """A subscription's messages on their way to the node, as bytes; counts those that are missing among them."""

    def __init__(self, topic: str, counts: Counter[str], subscription: Subscription) -> None:
        """Count under the topic's name."""
        self._name, self._counts = lost_name(topic), counts
        self._subscription = subscription
        self._gaps = SequenceGaps()

    def take(self, most: int) -> list[bytes]:
        """Return up to ``most`` messages that wait, oldest first."""
        # Only the caller's thread destroys the subscription, so that its handle need not be held for each message.
        subscription, raws = self._subscription, list[bytes]()
        take = subscription.handle.take_message
        while len(raws) < most and (taken := take(subscription.msg_type, True)) is not None:
            raws.append(taken[0])
            self._saw(taken[1])
        return raws

    def _saw(self, info: MessageInfo) -> None:
        """Note the number of a message."""
        number = info["publication_sequence_number"]
        if number is None:
            return
        if lost := self._gaps.add(number, self._subscription.get_publisher_count):
            self._counts[self._name] += lost
