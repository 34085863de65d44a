"""Temperature-drift compensation of MEMS accelerometers, offline and live on ROS 2."""

__version__ = "0.1.0"
