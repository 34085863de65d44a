"""Errors against the truth, and what a diagnosis that knows everything would reach."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.loop.cases import CHANNEL, Case
from benchmarks.loop.truth import Truth
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.evaluation.evaluate import MEAN_SECONDS, compare
from hgma_compensation.evaluation.noise_floor import noise_floor
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.recording.recording import Recording
from hgma_compensation.stamps import NANOSECONDS, Stamps
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.train import TrainingOptions, train

COLUMN = CHANNELS.index(CHANNEL)

GAP, SETTLING = 5.0, 10.0
"""s: after a gap in the samples the temperature is not known at once; for so long a recording is not judged."""

REFERENCE = Reference((STANDARD_GRAVITY,))
"""What the still sensor should show: both generators hold it upright."""


@dataclass(frozen=True)
class Error:
    """RMS in m/s² over means of 5 s of the held-out recording, less what the sensor really underwent.

    floor: by the white noise of the readout alone. best: what a perfect drift model with the calibration's causal
    temperature would leave, slow noise included.
    """

    rms: float
    floor: float
    best: float


def training_options(seed: int = 1, generations: int | None = None) -> TrainingOptions:
    """Return the options that all cases are trained with; generations: of the genetic search, None for its default."""
    genetic = GeneticSettings() if generations is None else GeneticSettings(generations=generations)
    return TrainingOptions(channels=(CHANNEL,), reference=REFERENCE, seed=seed, genetic=genetic)


def error_of(case: Case, calibration: Calibration) -> Error:
    """Return the error of a calibration on the held-out recording."""
    return _error(case.holdout, case.truths[-1], calibration)


def oracle_error(case: Case, options: TrainingOptions) -> Error:
    """Return the error of the same method on the same recordings with the true effects and inputs taken away."""
    clean = [_without(r, truth) for r, truth in zip(case.recordings, case.truths, strict=True)]
    truth = case.truths[-1]
    still = replace(
        truth,
        drift=truth.drift - truth.effect,
        effect=np.zeros_like(truth.effect),
        acceleration=np.full_like(truth.acceleration, STANDARD_GRAVITY),
    )
    return _error(clean[-1], still, train(clean[:-1], options))


def _without(recording: Recording, truth: Truth) -> Recording:
    values = recording.values.copy()
    values[:, COLUMN] -= truth.effect + truth.acceleration - STANDARD_GRAVITY
    return replace(recording, values=values)


def _error(recording: Recording, truth: Truth, calibration: Calibration) -> Error:
    result = compensate_recording(recording, calibration)
    rows = settled(recording.stamps)
    stamps, temperature = recording.stamps[rows], result.features[rows, 0]
    raw = recording.values[rows, COLUMN] - truth.acceleration[rows]
    compensated = result.values[rows, 0] - truth.acceleration[rows]
    # As it would be had the sensor been still.
    still = [(values + STANDARD_GRAVITY)[:, None] for values in (raw, compensated)]
    judged = compare(stamps, still[0], still[1], temperature, calibration, REFERENCE).channels[0]
    drift, true = truth.drift[rows], truth.temperature[rows]
    best = noise_floor(stamps, raw - drift, drift, (true, temperature), MEAN_SECONDS)
    return Error(judged.compensated.rms_error, judged.noise_floor, best.with_thermistor)


def settled(stamps: Stamps) -> NDArray[np.bool_]:
    """Return for each stamp (n,), ns, whether the start or the last gap is over for long enough."""
    gaps = np.concatenate([[0], np.flatnonzero(np.diff(stamps) > GAP * NANOSECONDS) + 1])
    rows = np.ones(len(stamps), dtype=bool)
    for first in gaps:
        rows &= (stamps < stamps[first]) | (stamps >= stamps[first] + SETTLING * NANOSECONDS)
    return rows
