"""Numbers out of messages and back into them, for the classes of rclpy and of rosbags alike.

Both have the same fields.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import AXES, CHANNELS, GROUPS
from hgma_compensation.errors import RefusedError
from hgma_compensation.stamps import NANOSECONDS, Stamps


def stamp_of(message: Any) -> int:
    """Return the header's stamp in ns."""
    stamp = message.header.stamp
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def imu_values(message: Any) -> tuple[float, ...]:
    """Return the six channels of an Imu message, in the order of CHANNELS."""
    a, w = message.linear_acceleration, message.angular_velocity
    return a.x, a.y, a.z, w.x, w.y, w.z


def absent_groups(message: Any) -> set[str]:
    """Return the fields that the message declares absent by -1 in their covariance (REP-145)."""
    return {group for group in GROUPS if getattr(message, f"{group}_covariance")[0] == -1.0}


def block_offsets(count: int, interval: float) -> Stamps:
    """Return the stamps (n,) of the samples of a block in ns after its own; interval: s."""
    return np.rint(np.arange(count) * (interval * 1e9)).astype(np.int64)


def check_block(block: Any, source: str) -> None:
    """Raise RefusedError where the axes of an AccelBlock differ in length or its interval is not positive."""
    lengths = {len(getattr(block, axis)) for axis in AXES}
    if len(lengths) != 1:
        raise RefusedError(f"{source}: an AccelBlock has axes of different lengths ({sorted(lengths)})")
    if not 0.0 < block.sample_interval < 3600.0:
        raise RefusedError(f"{source}: an AccelBlock has sample_interval {block.sample_interval}, must be above 0 s")


def block_samples(message: Any, source: str) -> tuple[Stamps, NDArray[np.float64]]:
    """Return stamps (n,) and accelerations (n, 3) of an AccelBlock; raises RefusedError as ``check_block``."""
    check_block(message, source)
    values = np.stack([np.asarray(getattr(message, axis), dtype=np.float64) for axis in AXES], axis=1)
    return stamp_of(message) + block_offsets(len(values), message.sample_interval), values


def patch_imu(message: Any, channels: Sequence[str], values: Sequence[float]) -> None:
    """Overwrite the named channels of an Imu message; every other field stays as it is."""
    for channel, value in zip(channels, values, strict=True):
        group, axis = channel.split(".")
        setattr(getattr(message, group), axis, value)


def patch_covariances(message: Any, channels: Sequence[str], variances: NDArray[np.float64] | None) -> bool:
    """Add variances (c,) of the channels to their fields' covariances, None for nothing; return if all were valid.

    One that is not finite, or has a negative variance, becomes the unknown one, all 0 (REP-145), before.
    """
    all_valid = True
    for group in GROUPS:
        columns = {AXES.index(c.split(".")[1]): n for n, c in enumerate(channels) if c.startswith(group)}
        if not columns:
            continue
        covariance = getattr(message, f"{group}_covariance")
        valid = bool(np.isfinite(covariance).all()) and min(covariance[::4]) >= 0.0
        all_valid = all_valid and valid
        if valid and variances is None:
            continue
        patched = np.array(covariance, dtype=np.float64) if valid else np.zeros(9)
        if variances is not None:
            for axis, column in columns.items():
                patched[4 * axis] += variances[column]
        setattr(message, f"{group}_covariance", patched)
    return all_valid


def patch_block(message: Any, channels: Sequence[str], values: NDArray[np.float64]) -> None:
    """Overwrite the axes of an AccelBlock that the channels cover, values (n, c)."""
    for column, channel in enumerate(channels):
        group, axis = channel.split(".")
        if group == GROUPS[0]:
            setattr(message, axis, values[:, column].astype(np.float32))


def widen_block(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the accelerations (n, 3) of a block as columns of CHANNELS (n, 6); it carries no angular rate."""
    wide = np.zeros((len(values), len(CHANNELS)))
    wide[:, : len(AXES)] = values
    return wide
