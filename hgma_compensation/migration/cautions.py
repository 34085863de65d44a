"""What the user of exported parameters should know before flying with them."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import AXES, GROUPS
from hgma_compensation.migration import ardupilot, px4
from hgma_compensation.migration.cubic import FittedCubic, Span
from hgma_compensation.migration.parameters import groups_of
from hgma_compensation.quantities import quantity


def warnings_of(
    calibration: Calibration,
    fitted: Sequence[FittedCubic],
    span: Span,
    instance: int,
    device_ids: Mapping[str, int] | None,
) -> tuple[str, ...]:
    """Return the warnings; device_ids: those given for PX4, None for ArduPilot."""
    found = list(_of_calibration(calibration, fitted))
    if device_ids is None:
        found += _of_ardupilot(fitted, span, instance)
    else:
        found += _of_px4(fitted, instance, device_ids)
    return tuple(found)


def _of_calibration(calibration: Calibration, fitted: Sequence[FittedCubic]) -> Iterator[str]:
    box = calibration.calibrated_range
    if not box.lower[1] <= 0.0 <= box.upper[1]:
        slowest = quantity(min(box.lower[1], box.upper[1], key=abs), "°C/s", 3)
        yield (
            "the training recordings never rested: the calibrated rates do not include 0 °C/s, the cubic is that of "
            f"the slowest, {slowest}; record soaks and train again"
        )
    names = _names(fitted)
    for group in groups_of(names):
        missing = [f"{group}.{axis}" for axis in AXES if f"{group}.{axis}" not in names]
        if missing:
            yield f"no calibration of {', '.join(missing)}: coefficients of 0, the autopilot leaves it as it is"


def _of_px4(fitted: Sequence[FittedCubic], instance: int, device_ids: Mapping[str, int]) -> Iterator[str]:
    covered = groups_of(_names(fitted))
    for group in covered:
        if group not in device_ids:
            yield (
                f"TC_{px4.LETTERS[group]}{instance}_ID is not in the file: PX4 uses the coefficients only for the "
                f"sensor that it names; give {px4.ID_OPTIONS[group]} with the number in the column device_id of the "
                "log, or set it on the vehicle"
            )
    for group in device_ids:
        if group not in covered:
            yield f"{px4.ID_OPTIONS[group]} is not used: the calibration has no channel of {group}"


def _of_ardupilot(fitted: Sequence[FittedCubic], span: Span, instance: int) -> Iterator[str]:
    lowest, highest = ardupilot.TEMPERATURES
    prefix = f"INS_TCAL{instance + 1}_"
    if span.lowest < lowest or span.highest > highest:
        yield (
            f"{prefix}TMIN and TMAX are documented for {lowest:g} to {highest:g} °C, this calibration has "
            f"{span.lowest:.4g} to {span.highest:.4g}: narrow it with --range"
        )
    if span.highest - span.lowest < ardupilot.SMALLEST_SPAN:
        yield f"{prefix}TMAX must be {ardupilot.SMALLEST_SPAN:g} °C or more above TMIN, as its description says"
    covered = groups_of(_names(fitted))
    for group in GROUPS:
        if group not in covered:
            yield (
                f"{prefix}{ardupilot.NAMES[group]}1 to 3 are not in the file and stay as the vehicle has them, "
                "while TMIN and TMAX become those of this calibration"
            )
    for f in fitted:
        largest = float(np.abs(f.cubic.evaluate(span.grid())).max())
        if f.cubic.channel.startswith(GROUPS[0]) and largest > ardupilot.LARGEST_OFFSET:
            yield (
                f"{f.cubic.channel} drifts by up to {quantity(largest, 'm/s^2', 3)}: INS_ACCOFFS, which must take up "
                f"what there is of it at the temperature of the accelerometer's calibration, is documented for ±"
                f"{ardupilot.LARGEST_OFFSET:g} m/s²"
            )


def _names(fitted: Sequence[FittedCubic]) -> set[str]:
    return {f.cubic.channel for f in fitted}
