"""The six channels of a sensor_msgs/Imu that a calibration can cover, and their units."""

from collections.abc import Sequence

from hgma_compensation.errors import RefusedError

AXES = ("x", "y", "z")
UNITS = {"linear_acceleration": "m/s^2", "angular_velocity": "rad/s"}
GROUPS = tuple(UNITS)
CHANNELS = tuple(f"{group}.{axis}" for group in GROUPS for axis in AXES)


def group_of(channel: str) -> str:
    """Return the Imu field that holds the channel: "linear_acceleration" or "angular_velocity"."""
    return channel.split(".")[0]


def unit_of(channel: str) -> str:
    """Return the unit of a channel, as written in every file and report."""
    return UNITS[group_of(channel)]


def columns_of(channels: Sequence[str]) -> list[int]:
    """Return the columns of the channels in an array whose columns are CHANNELS."""
    return [CHANNELS.index(channel) for channel in channels]


def parse_channels(text: str) -> tuple[str, ...]:
    """Return the channels of a comma-separated list, in the order of CHANNELS.

    Raises RefusedError for a name that is not a channel and for an empty list.
    """
    names = [name.strip() for name in text.split(",") if name.strip()]
    for name in names:
        if name not in CHANNELS:
            raise RefusedError(f"channel {name!r} does not exist: choose from {', '.join(CHANNELS)}")
    if not names:
        raise RefusedError(f"no channel is named: choose from {', '.join(CHANNELS)}")
    return tuple(channel for channel in CHANNELS if channel in names)
