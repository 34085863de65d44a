"""Parameters of an autopilot, and files of them."""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from hgma_compensation.channels import AXES, CHANNELS, group_of
from hgma_compensation.migration.cubic import Cubic

FLU = {"x": 1.0, "y": -1.0, "z": -1.0}
"""From ROS axes (REP-103: forward, left, up) to those of autopilots (forward, right, down): half a turn about x."""


class AxisConvention(str, Enum):
    """Axes of the calibration.

    SAME: those of the autopilot's own sensor topic. FLU: forward, left, up, as a ROS driver publishes them.
    """

    SAME = "same"
    FLU = "flu"


@dataclass(frozen=True)
class Parameter:
    """Name and value; an int stands for an integer parameter, a float for one of single precision."""

    name: str
    value: int | float

    @property
    def text(self) -> str:
        """The value with as many digits as single precision needs to be read back to the bit, and no exponent."""
        if isinstance(self.value, int):
            return str(self.value)
        return np.format_float_positional(np.float32(self.value), unique=True, trim="0")


def in_axes(cubics: Sequence[Cubic], axes: AxisConvention) -> dict[str, Cubic]:
    """Return the cubics by channel, in the axes of the autopilot.

    The axes keep their names, so only signs change: an offset along a turned axis is the negative one.
    """
    signs = FLU if axes is AxisConvention.FLU else dict.fromkeys(AXES, 1.0)
    return {c.channel: Cubic(c.channel, c.reference, signs[c.channel[-1]] * c.coefficients) for c in cubics}


def groups_of(channels: Container[str]) -> tuple[str, ...]:
    """Return the Imu fields that have some of the channels, "linear_acceleration" and "angular_velocity"."""
    return tuple(dict.fromkeys(group_of(channel) for channel in CHANNELS if channel in channels))


def coefficient(cubics: Mapping[str, Cubic], group: str, axis: str, power: int) -> float:
    """Return a coefficient, 0 of an axis that the calibration does not cover."""
    cubic = cubics.get(f"{group}.{axis}")
    return 0.0 if cubic is None else float(cubic.coefficients[power])
