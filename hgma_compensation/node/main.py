"""Entry point of ``compensation_node`` and ``hgma node``."""

import sys
from collections.abc import Sequence

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from hgma_compensation.node.compensation_node import CompensationNode


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until SIGINT, SIGTERM or a shutdown of ROS; all of them are a clean end."""
    rclpy.init(args=list(args) if args is not None else sys.argv)
    executor = SingleThreadedExecutor()
    node = CompensationNode()
    executor.add_node(node)
    try:
        node.start()
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        # In this order: a context that goes first makes the executor's last wait raise.
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
