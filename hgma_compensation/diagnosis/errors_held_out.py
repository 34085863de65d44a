"""Error of a calibration on the recording held out: means of 5 s of what the node would publish."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import columns_of
from hgma_compensation.diagnosis.blocks import make_blocks
from hgma_compensation.diagnosis.held_samples import HeldSamples
from hgma_compensation.diagnosis.inputs import find_inputs
from hgma_compensation.diagnosis.recordings import Material
from hgma_compensation.diagnosis.runs import Run, read_smoothed
from hgma_compensation.evaluation.evaluate import MEAN_SECONDS
from hgma_compensation.pipeline.pipeline import CHUNK, Pipeline
from hgma_compensation.recording.compensated_bag import feed, usable_parts
from hgma_compensation.recording.sliced import Column, Sampled, in_parts
from hgma_compensation.recording.spooled import Spooled
from hgma_compensation.training.blocks import noise_of_means

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeldOutError:
    """time: (n,) s from the start of the hold-out. temperature, rate: (n,) °C, °C/s. error: (n,) of means of 5 s.

    samples: compensated, for the Allan deviation.
    """

    time: Array
    temperature: Array
    rate: Array
    error: Array
    samples: HeldSamples

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
    number = calibration.names.index(channel)
    compensated = [_compensated(run.recording, calibration, number) for run in runs]
    blocks = make_blocks(runs, channel, MEAN_SECONDS, samples=compensated)
    deviation = blocks.values - calibration.channels[number].reference
    inputs = find_inputs(blocks, deviation)
    held = material.held_rows(blocks)
    fitted = inputs.usable & ~held
    if inputs.columns.shape[1] and fitted.any():
        levels, *_ = np.linalg.lstsq(inputs.columns[fitted], deviation[fitted], rcond=None)
        deviation = deviation - inputs.columns @ levels
    rows = held & inputs.usable
    index = int(blocks.run[rows][0]) if rows.any() else 0
    run = runs[index]
    temperature, rate = read_smoothed(run.smoothed, blocks.stamps[rows])
    return HeldOutError(
        time=np.asarray((blocks.stamps[rows] - material.held[0]) * 1e-9, dtype=np.float64),
        temperature=temperature,
        rate=rate,
        error=deviation[rows],
        samples=HeldSamples(_held_out(material, run.recording, compensated[index])),
    )


def _held_out(material: Material, recording: Sampled, compensated: Column) -> Iterator[tuple[NDArray[np.int64], Array]]:
    """Yield the stamps (n,) and compensated samples (n,) of a recording that belong to the hold-out."""
    for part in in_parts(recording.samples, CHUNK):
        stamps = recording.stamps[part]
        held = material.held_out(stamps, recording)
        yield stamps[held], compensated[part][held]


def _compensated(recording: Sampled, calibration: Calibration, number: int) -> Column:
    """Return one of the calibrated channels compensated (n,), NaN where a sample is not usable."""
    compensated, columns = Spooled(1), columns_of(calibration.names)
    pipeline = Pipeline(calibration)
    feed(pipeline, recording)
    for part, usable in usable_parts(recording, calibration):
        own = np.full((len(usable), 1), np.nan)
        values = recording.values[part][usable]
        own[usable, 0] = pipeline.compensate(recording.stamps[part][usable], values[:, columns], values).values[
            :, number
        ]
        compensated.add(own)
    return Column(compensated, 0)
