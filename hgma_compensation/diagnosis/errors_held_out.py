"""Error of a calibration on the recording held out: means of 5 s of what the node would publish."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS, columns_of
from hgma_compensation.diagnosis.blocks import make_blocks
from hgma_compensation.diagnosis.inputs import find_inputs
from hgma_compensation.diagnosis.recordings import Material
from hgma_compensation.diagnosis.runs import Run, read_smoothed
from hgma_compensation.evaluation.evaluate import MEAN_SECONDS
from hgma_compensation.pipeline.pipeline import CHUNK, Pipeline
from hgma_compensation.recording.compensated_bag import feed, usable_rows
from hgma_compensation.recording.recording import Recording
from hgma_compensation.training.blocks import noise_of_means

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeldOutError:
    """time: (n,) s from the start of the hold-out. temperature, rate: (n,) °C, °C/s. error: (n,) of means of 5 s.

    compensated: samples (m,), with stamps (m,) ns, for the Allan deviation.
    """

    time: Array
    temperature: Array
    rate: Array
    error: Array
    stamps: NDArray[np.int64]
    compensated: Array

    @property
    def rms(self) -> float:
        """RMS of the errors, in the channel's unit."""
        return float(np.sqrt(np.mean(self.error**2)))

    @property
    def noise(self) -> float:
        """White noise of such a mean."""
        return noise_of_means(self.error)


def held_out_error(material: Material, runs: Sequence[Run], calibration: Calibration, channel: str) -> HeldOutError:
    """Return the errors of a calibration on the hold-out, run through the pipeline from its start, as evaluate does.

    Real acceleration does not count: outliers and motion are left out, and levels that recur are taken at what they
    are in the recordings that were learned from.
    """
    column, number = CHANNELS.index(channel), calibration.names.index(channel)
    reference = calibration.channels[number].reference
    compensated = []
    for run in runs:
        own = _compensated(run.recording, calibration, number)
        # Only the column of the channel is read.
        values = np.broadcast_to(own[:, None], (len(own), len(CHANNELS)))
        compensated.append(replace(run, recording=replace(run.recording, values=values)))
    blocks = make_blocks(compensated, channel, MEAN_SECONDS)
    deviation = blocks.values - reference
    inputs = find_inputs(blocks, deviation)
    held = material.held_rows(blocks)
    fitted = inputs.usable & ~held
    if inputs.columns.shape[1] and fitted.any():
        levels, *_ = np.linalg.lstsq(inputs.columns[fitted], deviation[fitted], rcond=None)
        deviation = deviation - inputs.columns @ levels
    rows = held & inputs.usable
    index = int(blocks.run[rows][0]) if rows.any() else 0
    run = compensated[index]
    samples = material.held_out(run.recording.stamps, run.recording)
    temperature, rate = read_smoothed(run.smoothed, blocks.stamps[rows])
    return HeldOutError(
        time=np.asarray((blocks.stamps[rows] - material.held[0]) * 1e-9, dtype=np.float64),
        temperature=temperature,
        rate=rate,
        error=deviation[rows],
        stamps=run.recording.stamps[samples],
        compensated=run.recording.values[samples, column],
    )


def _compensated(recording: Recording, calibration: Calibration, number: int) -> Array:
    """Return one of the calibrated channels compensated (n,), NaN where a sample is not usable."""
    compensated = np.full(len(recording.stamps), np.nan)
    rows, columns = usable_rows(recording, calibration), columns_of(calibration.names)
    pipeline = Pipeline(calibration)
    feed(pipeline, recording)
    for start in range(0, len(rows), CHUNK):
        usable = start + np.flatnonzero(rows[start : start + CHUNK])
        values = recording.values[usable]
        compensated[usable] = pipeline.compensate(recording.stamps[usable], values[:, columns], values).values[
            :, number
        ]
    return compensated
