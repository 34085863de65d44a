"""Entry point of ``compensation_node`` and ``hgma node``."""

import gc
import signal
import sys
import threading
from collections.abc import Sequence

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from hgma_compensation.node.compensation_node import CompensationNode

STOP_LATENCY = 0.2
"""s after which a signal is noticed at the latest."""

GIVE_WAY = 1e-4
"""s for which a thread that reads a calibration may keep the interpreter from the one that compensates."""


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until SIGINT, SIGTERM or a shutdown of ROS; all of them are a clean end."""
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    # rclpy's own handlers wake the executor from a thread of theirs, which races with its destruction and
    # crashes about one end in twenty (Jazzy, 7.1.6).
    rclpy.init(args=list(args) if args is not None else sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    executor = SingleThreadedExecutor()
    node = CompensationNode()
    executor.add_node(node)
    try:
        node.start()
        share_interpreter()
        while not stop.is_set() and rclpy.ok():
            executor.spin_once(timeout_sec=STOP_LATENCY)
    except ExternalShutdownException:
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


def share_interpreter() -> None:
    """Let no other thread, and no search for garbage among all that was imported, hold up the stream for long."""
    sys.setswitchinterval(GIVE_WAY)
    gc.collect()
    gc.freeze()


if __name__ == "__main__":
    sys.exit(main())
