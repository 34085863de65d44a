"""Noise of the Kalman stage from a recording."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import columns_of
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.design import settled_filter
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.recording.source import Source
from hgma_compensation.stamps import NANOSECONDS, Stamps
from hgma_compensation.training.blocks import noise_of_means

LEAST_REDUCTION = 1.1
"""Noise reduction below which a filter costs lag and gives nothing."""


TIME_CONSTANTS = {FilterMode.SMOOTH: 1.0, FilterMode.BIAS: 300.0}
"""s, unless the user gives one: a bias wanders slowly, and must not follow a manoeuvre."""


MOST_SAMPLES = 1 << 20
"""Samples up to which the noise is told from all of them."""

STRETCHES, STRETCH = 64, 4096
"""Of a longer recording so many stretches of so many samples are taken, evenly spread."""


def spread_samples(recording: Source, channels: Sequence[str]) -> tuple[Stamps, NDArray[np.float64]]:
    """Return stamps (n,) and values (n, c) of a recording's samples, of a long one those of evenly spread stretches.

    Where one stretch ends and the next begins, two differences are no noise: medians are deaf to so few.
    """
    parts, done, columns = [], 0, columns_of(channels)
    long, period = recording.samples > MOST_SAMPLES, recording.samples // STRETCHES
    for stamps, values in recording.windows():
        chosen = (done + np.arange(len(stamps))) % period < STRETCH if long else np.ones(len(stamps), dtype=np.bool_)
        parts.append((stamps[chosen], values[chosen][:, columns]))
        done += len(stamps)
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def design_filter(
    mode: FilterMode,
    time_constant: float | None,
    stamps: Stamps,
    values: NDArray[np.float64],
    channel: str,
    *,
    error: float,
    block: float,
) -> FilterSettings:
    """Return the settings of one channel's stage.

    stamps, values: samples (n,) of the channel; their white noise gives R of Eq. (9). time_constant: s over which
    the settled filter averages; the longer it is, the less noise and the more lag. error: RMS error of the drift
    model over means of ``block`` s. Less the white noise of such a mean it is the wander of the level, which the
    gate must not take for motion; BIAS starts from it. Raises RefusedError where the filter would do nothing.
    """
    if mode is FilterMode.OFF:
        return FilterSettings()
    time_constant = TIME_CONSTANTS[mode] if time_constant is None else time_constant
    interval = float(np.median(np.diff(stamps))) / NANOSECONDS
    white = noise_of_means(values[np.isfinite(values)]) * np.sqrt(max(interval, 0.0))
    if not white > 0.0:
        raise RefusedError(f"{channel} has no noise that a filter could smooth: train it with --filter off")
    noise = RandomWalkNoise.with_time_constant(float(white), time_constant)
    reduction = settled_filter(noise, interval).noise_reduction
    if reduction < LEAST_REDUCTION:
        raise RefusedError(
            f"{channel}: a filter of {time_constant:g} s on samples every {interval:g} s divides the noise by "
            f"{reduction:.2f} only: give a longer --filter-time-constant, or --filter off"
        )
    wander = float(np.sqrt(max(error**2 - white**2 / block, 0.0)))
    return FilterSettings(mode, noise, wander=wander, initial_bias=error if mode is FilterMode.BIAS else 0.0)
