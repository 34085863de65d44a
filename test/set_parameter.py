"""What ``ros2 param set NODE NAME VALUE`` does, for machines without ros2cli."""

import os
import sys

import yaml
from robot import Robot


def main(node: str, name: str, value: str) -> int:
    """Set the parameter; 1 where the node refuses."""
    peer = Robot(int(os.environ["ROS_DOMAIN_ID"]))
    assert node == "/compensation_node"
    result = peer.set_parameter(name, yaml.safe_load(value))
    peer.close()
    print("Set parameter successful" if result.successful else f"Setting parameter failed: {result.reason}")
    return 0 if result.successful else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
