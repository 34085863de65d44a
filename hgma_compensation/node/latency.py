"""How old samples are when their outputs leave the node, and how long the node itself had them."""

import time

from rclpy.clock import Clock
from rclpy.node import Node


class Latency:
    """Since the last report; a Reporter of the diagnostics.

    The age is that of a sample's stamp on the node's clock, for the first one after each report: what driver, network
    and node took together, where that clock and the driver's are one. It says nothing under a bag that is played
    without /clock.
    """

    def __init__(self, node: Node) -> None:
        """Use the node's clock."""
        self._clock: Clock = node.get_clock()
        self._begun = 0.0
        self._longest = 0.0
        self._age: float | None = None
        self._due = True

    def begin(self) -> None:
        """Messages have been taken."""
        self._begun = time.perf_counter()

    def end(self, stamp: int) -> None:
        """Their outputs are published; stamp: of the newest one, ns."""
        self._longest = max(self._longest, time.perf_counter() - self._begun)
        # Reading the clock costs a tenth of a sample.
        if self._due:
            self._age, self._due = (self._clock.now().nanoseconds - stamp) * 1e-9, False

    def problems(self) -> list[str]:
        """Return nothing: what is too long is for the operator to say."""
        return []

    def values(self) -> list[tuple[str, str]]:
        """Return the figures, and begin anew."""
        longest, self._longest, self._due = self._longest, 0.0, True
        age = "" if self._age is None else f"{self._age:.6f}"
        return [("processing_milliseconds_longest", f"{1e3 * longest:.3f}"), ("stamp_age_seconds", age)]
