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


STANDARD = {
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "geometry_msgs/msg/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/msg/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    TEMPERATURE: "std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n",
    IMU: (
        "std_msgs/Header header\n"
        "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
        "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
        "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
    ),
}
"""Definitions of ROS 2 Jazzy, of those types that are read and written here (common_interfaces, rcl_interfaces).

The library has them too, among 150 others that it would all make classes of: a fifth of a second at each start.
"""


@cache
def typestore() -> Typestore:
    """Return the types that are read and written here."""
    store = get_typestore(Stores.EMPTY)
    texts = STANDARD | {name: _definition(name).read_text("utf-8") for name in (SUPPLY_VOLTAGE, ACCEL_BLOCK, STATE)}
    found = {}
    for name, text in texts.items():
        found.update(get_types_from_msg(text, name))
    store.register(found)
    return store


@cache
def _all_types() -> Typestore:
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register({name: typestore().fielddefs[name] for name in (SUPPLY_VOLTAGE, ACCEL_BLOCK, STATE)})
    return store


def typestore_of(message_type: str) -> Typestore:
    """Return types among which that one is, if it is one of ROS 2 Jazzy or of hgma_msgs."""
    return typestore() if message_type in typestore().fielddefs else _all_types()


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
