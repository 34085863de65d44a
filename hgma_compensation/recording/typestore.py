"""Message definitions for reading and writing bags without a ROS installation."""

import os
import sys
from functools import cache
from pathlib import Path

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from hgma_compensation.errors import RefusedError

IMU = "sensor_msgs/msg/Imu"
TEMPERATURE = "sensor_msgs/msg/Temperature"
SUPPLY_VOLTAGE = "hgma_msgs/msg/SupplyVoltage"
ACCEL_BLOCK = "hgma_msgs/msg/AccelBlock"
STATE = "hgma_msgs/msg/CompensationState"


@cache
def typestore() -> Typestore:
    """Return the types of ROS 2 Jazzy and of hgma_msgs."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for name in (SUPPLY_VOLTAGE, ACCEL_BLOCK, STATE):
        store.register(get_types_from_msg(_definition(name).read_text(encoding="utf-8"), name))
    return store


def _definition(name: str) -> Path:
    """Return the .msg file of a type of hgma_msgs: of the installation, else of the source tree."""
    package, _, message = name.split("/")
    prefixes = [*os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep), sys.prefix]
    candidates = [Path(prefix, "share", package, "msg", f"{message}.msg") for prefix in prefixes if prefix]
    candidates.append(Path(__file__).parents[2] / package / "msg" / f"{message}.msg")
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise RefusedError(f"the package {package} is not installed: run make, or source your ROS 2 workspace")
