"""The ROS 2 node: moves messages in and out; all arithmetic is elsewhere."""
