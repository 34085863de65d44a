"""What is asked of an export, checked against what the autopilot has."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from hgma_compensation.errors import RefusedError
from hgma_compensation.migration import ardupilot, px4
from hgma_compensation.migration.parameters import AxisConvention


class Format(str, Enum):
    """Files that can be written: QGroundControl's, commands for PX4's shell, ArduPilot's ground stations'."""

    PX4 = "px4"
    PX4_SHELL = "px4-nsh"
    ARDUPILOT = "ardupilot"


@dataclass(frozen=True)
class Target:
    """instance: of the autopilot's sensor, from 0. device_ids: PX4's, by Imu field.

    span: °C wanted, None for all that is calibrated. channels: those wanted, None for all.
    """

    format: Format
    instance: int = 0
    axes: AxisConvention = AxisConvention.SAME
    device_ids: Mapping[str, int] | None = None
    span: tuple[float, float] | None = None
    channels: tuple[str, ...] | None = None

    @property
    def is_px4(self) -> bool:
        """Whether PX4 is to use it."""
        return self.format is not Format.ARDUPILOT

    def check(self) -> None:
        """Raise RefusedError for a sensor that the autopilot does not have, and an id that is none."""
        instances = px4.INSTANCES if self.is_px4 else ardupilot.INSTANCES
        if not 0 <= self.instance < instances:
            raise RefusedError(
                f"--instance {self.instance}: {self.format.value} has parameters for sensors 0 to {instances - 1}, "
                "counted from 0"
            )
        for group, number in (self.device_ids or {}).items():
            flag = px4.ID_OPTIONS[group]
            if not self.is_px4:
                raise RefusedError(f"{flag}: ArduPilot's parameters name no device, leave it out")
            if not 0 < number <= px4.LARGEST_ID:
                raise RefusedError(
                    f"{flag} {number}: give the number in the column device_id of sensor_accel or sensor_gyro, "
                    f"1 to {px4.LARGEST_ID}"
                )

    def wanted(self, calibrated: Sequence[str]) -> tuple[str, ...]:
        """Return the channels to export; raises RefusedError for one that is not calibrated."""
        for channel in self.channels or ():
            if channel not in calibrated:
                raise RefusedError(
                    f"--channels {channel}: the calibration has {', '.join(calibrated)}, choose among them "
                    "or train the channel"
                )
        return tuple(calibrated) if self.channels is None else self.channels
