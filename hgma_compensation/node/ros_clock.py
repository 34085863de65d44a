"""The node's clock where it is not the machine's: jumps are counted, and silence on /clock is said."""

import time
from collections import Counter
from collections.abc import Callable

from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.node import Node

from hgma_compensation.node.parameters import USE_SIM_TIME
from hgma_compensation.pipeline.transport import ROS_TIME_JUMPED_BACK

SILENCE = 5.0
"""s of wall time after which a clock that does not move is worth a word."""

LOG_PERIOD = 10.0
"""s of wall time between two words about jumps: two publishers of /clock make a hundred a second."""


class ClockWatch:
    """Says when a clock stops moving and when it moves again, once each."""

    def __init__(self, monotonic: Callable[[], float] = time.monotonic) -> None:
        """Measure with a clock that never jumps, in s."""
        self._monotonic = monotonic
        self._moved_at = monotonic()
        self._last: int | None = None
        self.silent = False

    def look(self, now: int) -> bool:
        """Take the watched clock's time (ns) and return whether ``silent`` has changed by it."""
        moved = now != self._last and self._last is not None
        if moved or self._last is None:
            self._last, self._moved_at = now, self._monotonic()
        before = self.silent
        self.silent = (before and not moved) or self._monotonic() - self._moved_at > SILENCE
        return self.silent is not before

    def forget(self) -> None:
        """Start anew, as when another clock is to be watched."""
        self._last, self.silent = None, False


class RosClock:
    """Watches the clock of a node that may follow /clock, and measures time between reports with it."""

    def __init__(self, node: Node, counts: Counter[str]) -> None:
        """Count jumps into ``counts``, log as the node."""
        self._node, self._counts, self._clock = node, counts, node.get_clock()
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._watch = ClockWatch()
        self._jumped = False
        self._measured = self._clock.now().nanoseconds, self._steady.now().nanoseconds
        # Any step forward that is longer than a pause of a player; the handles end with this object.
        threshold = JumpThreshold(
            min_forward=Duration(seconds=SILENCE), min_backward=Duration(nanoseconds=-1), on_clock_change=True
        )
        self._handle = self._clock.create_jump_callback(threshold, post_callback=self._on_jump)
        node.create_timer(1.0, self._look, clock=self._steady)

    def elapsed(self) -> float:
        """Return the s of ROS time since the last call; of wall time where ROS time has jumped meanwhile."""
        now = self._clock.now().nanoseconds, self._steady.now().nanoseconds
        which = 1 if self._jumped else 0
        seconds = (now[which] - self._measured[which]) * 1e-9
        self._measured, self._jumped = now, False
        return seconds

    def _on_jump(self, jump: TimeJump) -> None:
        self._jumped = True
        back = -jump.delta.nanoseconds * 1e-9
        if back > 0.0 and not self._is_change_of_source(jump):
            self._counts[ROS_TIME_JUMPED_BACK] += 1
            self._node.get_logger().warning(
                f"ROS time jumped back by {back:.3f} s; samples go by their own stamps, diagnostics go on",
                throttle_duration_sec=LOG_PERIOD,
                throttle_time_source_type=self._steady,
            )

    @staticmethod
    def _is_change_of_source(jump: TimeJump) -> bool:
        return jump.clock_change.name in ("ROS_TIME_ACTIVATED", "ROS_TIME_DEACTIVATED")

    def _look(self) -> None:
        if not self._node.get_parameter(USE_SIM_TIME.name).value:
            return self._watch.forget()
        if not self._watch.look(self._clock.now().nanoseconds):
            return
        if self._watch.silent:
            self._node.get_logger().warning(
                f"use_sim_time is true and nothing has moved the time on /clock for {SILENCE:g} s: there are no "
                "diagnostics meanwhile; start hgma play --clock or the simulator, or set use_sim_time to false"
            )
        else:
            self._node.get_logger().info("/clock moves")
