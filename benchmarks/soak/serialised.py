"""Fields of serialised messages, read and written in place: what a process does that must keep up with a kilohertz."""

import struct
from typing import Any

from rclpy.serialization import serialize_message
from sensor_msgs.msg import Imu

from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import CompensationState

MARK = 123456789.125
STAMP = struct.Struct("<iI")
NUMBER = struct.Struct("<d")
STAMP_AT = 4
"""Behind the four bytes that tell the encoding."""


def stamp_of(raw: bytes) -> int:
    """Return the header's stamp, ns."""
    seconds, nanoseconds = STAMP.unpack_from(raw, STAMP_AT)
    return int(seconds) * NANOSECONDS + int(nanoseconds)


def imu_template(frame: str = "imu_link") -> bytearray:
    """Return a serialised Imu to be patched; all its numbers are 0."""
    message = Imu()
    message.header.frame_id = frame
    return bytearray(serialize_message(message))


def orientation_at(frame: str = "imu_link") -> int:
    """Return where the orientation's x lies in a serialised Imu of that frame: no calibration touches it."""
    message = Imu()
    message.header.frame_id = frame
    message.orientation.x = MARK
    return _place_of_mark(message)


def acceleration_at(frame: str = "imu_link") -> int:
    """Return where the acceleration's x lies in a serialised Imu of that frame."""
    message = Imu()
    message.header.frame_id = frame
    message.linear_acceleration.x = MARK
    return _place_of_mark(message)


def drift_at(frame: str, channels: list[str]) -> int:
    """Return where the drift begins in a serialised CompensationState of that frame and those channels."""
    message = CompensationState(channels=channels, drift=[MARK] * len(channels))
    message.header.frame_id = frame
    return _place_of_mark(message)


def _place_of_mark(message: Any) -> int:
    return bytes(serialize_message(message)).index(NUMBER.pack(MARK))
