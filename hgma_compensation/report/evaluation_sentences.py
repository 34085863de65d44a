"""An evaluation in plain words."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.evaluation.evaluate import ChannelEvaluation
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.report.pictures.errors import rates
from hgma_compensation.report.pictures.ramps import direction
from hgma_compensation.report.run_record import RunSummary
from hgma_compensation.report.sentences import NOTABLY_ABOVE
from hgma_compensation.report.words import SPACE, duration, number, quantity

MINUTE = 60.0
OFFSET = 0.7
"""Share of the error that its mean makes up, from which on it is called an offset: half of its square."""

STATUSES = {
    TemperatureStatus.SETTLING: "settling after a power-on",
    TemperatureStatus.STALE: "with a silent thermistor",
    TemperatureStatus.MISSING: "before the first thermistor sample",
    TemperatureStatus.INVALID: "with an unusable thermistor",
}


@dataclass(frozen=True)
class Worst:
    """The largest error of a mean over a minute, and where it is. time: s. rate: °C/s. way: +1, 0 or -1."""

    error: float
    time: float
    temperature: float
    rate: float
    way: int


def times_noise(channel: ChannelEvaluation) -> float | None:
    """Return the compensated error over the noise of the means; None where there are too few means to tell."""
    return channel.compensated.rms_error / channel.noise_floor if channel.noise_floor > 0.0 else None


def kind(channel: ChannelEvaluation) -> str:
    """Return good where noise is left, bad where compensation makes it worse, else calm."""
    times = times_noise(channel)
    if times is not None and times <= NOTABLY_ABOVE:
        return "good"
    return "bad" if channel.compensated.rms_error > channel.raw.rms_error else "calm"


BADGES = {"good": "only noise is left", "calm": "some drift is left", "bad": "worse than raw"}


def headline(channel: ChannelEvaluation) -> str:
    """Return the main thing."""
    raw, left, times = channel.raw.rms_error, channel.compensated.rms_error, times_noise(channel)
    if kind(channel) == "bad":
        return (
            f"Compensation makes the error larger: {quantity(left, channel.name)} after, "
            f"{quantity(raw, channel.name)} before. This calibration does not fit this recording."
        )
    fell = f"The error falls from {quantity(raw, channel.name)} to {quantity(left, channel.name)}"
    smaller = f", {number(raw / left)} times smaller" if left > 0.0 and raw > left else ""
    if times is None:
        return f"{fell}{smaller}."
    what = "no more than" if times <= 1.0 else f"{number(times, 2)}{SPACE}×"
    return f"{fell}{smaller}. What remains is {what} the noise of the means."


def worst(channel: ChannelEvaluation) -> Worst:
    """Return the largest error that lasts for a minute."""
    index = np.floor(channel.time / MINUTE).astype(np.int64)
    _, group, counts = np.unique(index, return_inverse=True, return_counts=True)
    rate = rates(channel.time, channel.temperature)
    columns = (channel.compensated_error, channel.time, channel.temperature, rate)
    error, time, temperature, mean_rate = (np.bincount(group, weights=column) / counts for column in columns)
    row = int(np.argmax(np.abs(error)))
    way = int(direction(rate)[group == row].sum())
    return Worst(float(error[row]), float(time[row]), float(temperature[row]), float(mean_rate[row]), int(np.sign(way)))


def remarks(channel: ChannelEvaluation) -> list[str]:
    """Return where the error is largest, and what it looks like."""
    at = worst(channel)
    ramp = f"{number(abs(60.0 * at.rate), 2)}{SPACE}°C/min"
    how = {1: f"while heating at {ramp}", -1: f"while cooling at {ramp}", 0: "at a steady temperature"}[at.way]
    said = [
        f"Largest over a minute: {quantity(at.error, channel.name)} at {number(at.temperature)}{SPACE}°C {how}, "
        f"{duration(at.time)} from the start."
    ]
    mean, rms = float(np.mean(channel.compensated_error)), channel.compensated.rms_error
    if kind(channel) != "good" and abs(mean) > OFFSET * rms:
        said.append(
            f"Most of it is a constant offset of {quantity(mean, channel.name)}: aging, another mounting, or a "
            "reference that is not the true value."
        )
    return said


def outside(summary: RunSummary) -> list[str]:
    """Return the share of samples outside of the calibrated range, where there are any."""
    if not summary.outside:
        return []
    return [
        f"{share(summary.outside, summary.samples).capitalize()} of the samples lie outside of the calibrated range of "
        "temperature, rate and product, where the drift is held at its edge."
    ]


def coverage(summary: RunSummary) -> list[str]:
    """Return the shares of samples whose temperature the calibration does not know or cannot use."""
    said = outside(summary)
    said += [
        f"{share(count, summary.samples).capitalize()} of the samples are {STATUSES[status]}."
        for status, count in summary.statuses.items()
        if status in STATUSES
    ]
    return said or ["All samples lie inside of the calibrated range, with a usable temperature."]


def share(count: int, of: int) -> str:
    """Return a share in percent, never 0 or 100 where it is not."""
    if count in (0, of):
        return "none" if count == 0 else "all"
    percent = 100.0 * count / of
    return f"less than 0.1{SPACE}%" if percent < 0.1 else f"{number(min(percent, 99.9), 3)}{SPACE}%"
