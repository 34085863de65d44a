"""Error of a recording before and after compensation."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of, unit_of
from hgma_compensation.evaluation.allan import AllanCurve, allan_curve, bias_instability, velocity_random_walk
from hgma_compensation.recording.compensated_bag import check_covered, compensate_recording, usable_rows
from hgma_compensation.recording.recording import Recording
from hgma_compensation.stamps import Stamps, seconds_between
from hgma_compensation.training.blocks import group_means, noise_of_means
from hgma_compensation.training.reference import Reference

MEAN_SECONDS = 5.0
"""Error and span are those of means over this time: drift, not noise."""


@dataclass(frozen=True)
class Measures:
    """Figures of one channel, in its unit (random walk: unit/√Hz); None where they are not defined."""

    rms_error: float
    span: float
    velocity_random_walk: float | None
    bias_instability: float | None
    samples: int


@dataclass(frozen=True)
class ChannelEvaluation:
    """One channel before and after. noise_floor: RMS of a 5 s mean by white noise alone.

    time (m,) s, temperature (m,) °C and the errors (m,) are those of the 5 s means.
    """

    name: str
    raw: Measures
    compensated: Measures
    noise_floor: float
    time: NDArray[np.float64]
    temperature: NDArray[np.float64]
    raw_error: NDArray[np.float64]
    compensated_error: NDArray[np.float64]


@dataclass(frozen=True)
class Evaluation:
    """All channels of a calibration on one recording."""

    calibration_id: str
    channels: tuple[ChannelEvaluation, ...]

    def as_json(self) -> dict[str, Any]:
        """Return the figures in the form that scripts rely on."""
        return {
            "calibration_id": self.calibration_id,
            "channels": {
                channel.name: {
                    "unit": unit_of(channel.name),
                    "raw": asdict(channel.raw),
                    "compensated": asdict(channel.compensated),
                    "noise_floor": channel.noise_floor,
                }
                for channel in self.channels
            },
        }


def evaluate(recording: Recording, calibration: Calibration, reference: Reference) -> Evaluation:
    """Return the errors of the recording, compensated as the node would do it.

    Raises RefusedError where the recording lacks a channel of the calibration or a thermistor.
    """
    check_covered(recording, calibration)
    result = compensate_recording(recording, calibration)
    rows = usable_rows(recording, calibration)
    raw = recording.values[rows][:, columns_of(calibration.names)]
    return compare(recording.stamps[rows], raw, result.values, result.features[:, 0], calibration, reference)


def compare(
    stamps: Stamps,
    raw: NDArray[np.float64],
    compensated: NDArray[np.float64],
    temperature: NDArray[np.float64],
    calibration: Calibration,
    reference: Reference,
) -> Evaluation:
    """Return the errors of raw against compensated samples, (n, c) each, however they were obtained.

    temperature: (n,) °C. With the reference "mean" each is compared with its own mean.
    """
    time = seconds_between(stamps, int(stamps[0]))
    index = np.floor(time / MEAN_SECONDS).astype(np.int64)
    means = group_means(index, np.column_stack([time, temperature, raw, compensated]))
    references = [reference.of(calibration.names, samples) for samples in (raw, compensated)]
    samples = np.concatenate([raw, compensated], axis=1)

    def figures(column: int, error: NDArray[np.float64]) -> Measures:
        return measures(allan_curve(stamps, samples[:, column]), error, len(stamps))

    return evaluation_of(calibration, Means(means, np.concatenate(references)), figures)


@dataclass(frozen=True)
class Means:
    """values: (m, 2 + 2c) means over MEAN_SECONDS of time, s, temperature, °C, raw and compensated channels.

    references: (2c,) of raw and compensated channels.
    """

    values: NDArray[np.float64]
    references: NDArray[np.float64]


def evaluation_of(
    calibration: Calibration, means: Means, figures: Callable[[int, NDArray[np.float64]], Measures]
) -> Evaluation:
    """Return the evaluation of means.

    figures: returns the measures of a column, raw channels before compensated ones, given the error (m,) of its means.
    """
    count = len(calibration.names)
    errors = means.values[:, 2:] - means.references
    channels = tuple(
        ChannelEvaluation(
            name=name,
            raw=figures(column, errors[:, column]),
            compensated=figures(count + column, errors[:, count + column]),
            noise_floor=noise_of_means(means.values[:, 2 + column]),
            time=means.values[:, 0],
            temperature=means.values[:, 1],
            raw_error=errors[:, column],
            compensated_error=errors[:, count + column],
        )
        for column, name in enumerate(calibration.names)
    )
    return Evaluation(calibration.calibration_id, channels)


def measures(curve: AllanCurve | None, error: NDArray[np.float64], samples: int) -> Measures:
    """Return the figures of an Allan curve and of the error (m,) of means."""
    return Measures(
        rms_error=float(np.sqrt(np.mean(error**2))),
        span=float(np.ptp(error)),
        velocity_random_walk=None if curve is None else velocity_random_walk(curve),
        bias_instability=None if curve is None else bias_instability(curve),
        samples=samples,
    )
