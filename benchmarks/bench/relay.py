"""The rival of the message path, written as everybody writes it: ``python -m benchmarks.bench.relay imu 1000``.

One callback for each message, which publishes it again; rclpy.spin, which is a SingleThreadedExecutor. Arguments: imu
or block, the depth of both queues, and reliable where the input is to be so. Imports nothing else: its start is what
an empty node's is.
"""

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy


def main() -> int:
    """Relay until SIGINT."""
    kind, depth, *options = sys.argv[1:]
    reliable = QoSProfile(depth=int(depth), reliability=ReliabilityPolicy.RELIABLE)
    best_effort = QoSProfile(depth=int(depth), reliability=ReliabilityPolicy.BEST_EFFORT)
    rclpy.init(args=[])
    node = Node("relay")
    if kind == "imu":
        from sensor_msgs.msg import Imu as Message

        source, sink = "accel/raw", "accel/compensated"
    else:
        from hgma_msgs.msg import AccelBlock as Message

        source, sink = "accel/raw_block", "accel/compensated_block"
    publisher = node.create_publisher(Message, sink, reliable)
    node.create_subscription(Message, source, publisher.publish, reliable if "reliable" in options else best_effort)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
