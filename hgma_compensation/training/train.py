"""Training: recordings in, calibration out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hgma_compensation import __version__
from hgma_compensation.calibration.calibration import (
    LONGEST_SENSOR_ID,
    Calibration,
    ChannelCalibration,
    ChannelError,
)
from hgma_compensation.calibration.document import with_id
from hgma_compensation.channels import CHANNELS
from hgma_compensation.drift.inputs import Array
from hgma_compensation.drift.model import CalibratedRange
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.recording.source import Source
from hgma_compensation.stamps import Stamps
from hgma_compensation.temperature.features import FeatureSettings, Product
from hgma_compensation.training.blocks import Blocks, block_means, noise_of_means
from hgma_compensation.training.filter_design import design_filter, spread_samples
from hgma_compensation.training.folds import Folds, cycle_folds
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.methods import Method, fit_drift
from hgma_compensation.training.reference import Reference
from hgma_compensation.training.thermistor import feature_settings

MOST_BLOCKS = 2500
"""Means that are fitted: more make the search slower and no better, so long recordings get longer blocks."""

SMALLEST_SPAN = 1.0
"""°C of temperature change below which there is no drift to learn."""

_NOTHING: tuple[Stamps, Array] = np.empty(0, dtype=np.int64), np.empty(0)
"""Samples where no filter is designed."""

Progress = Callable[[str, int, float], None]
"""Called with the channel, the generation and the best fitness so far."""


@dataclass(frozen=True)
class TrainingOptions:
    """What the user chose.

    block: shortest mean that is fitted, s. filter_time_constant: s, None for the default of the filter's mode.
    """

    method: Method = Method.RBF_GA
    channels: tuple[str, ...] | None = None
    reference: Reference = field(default_factory=Reference)
    seed: int = 1
    sensor_id: str | None = None
    block: float = 5.0
    delay: float = 60.0
    product: Product = Product.DELAY
    reference_temperature: float = 25.0
    filter: FilterMode = FilterMode.OFF
    filter_time_constant: float | None = None
    genetic: GeneticSettings = field(default_factory=GeneticSettings)


def train(recordings: Sequence[Source], options: TrainingOptions, progress: Progress | None = None) -> Calibration:
    """Return a calibration fitted to all recordings together; the same seed gives the same one.

    Raises RefusedError where the recordings cannot carry it.
    """
    sensor_id_of(recordings, options)
    channels = choose_channels(recordings, options.channels)
    settings = feature_settings(
        recordings,
        delay=options.delay,
        product=options.product,
        reference_temperature=options.reference_temperature,
    )
    block = block_length(recordings, options.block)
    blocks = block_means(recordings, channels, settings, block)
    return train_on_blocks(blocks, recordings, channels, settings, block, options, progress)


def sensor_id_of(recordings: Sequence[Source], options: TrainingOptions) -> str:
    """Return the name of the sensor that the calibration will carry; raises RefusedError where no file can carry it."""
    name = options.sensor_id or recordings[0].frame or "unnamed"
    if len(name) > LONGEST_SENSOR_ID:
        whose = "--sensor-id" if options.sensor_id else "the frame of the messages"
        raise RefusedError(
            f"{whose} has {len(name)} characters, more than the {LONGEST_SENSOR_ID} that a calibration can carry: "
            "give a shorter --sensor-id"
        )
    return name


def block_length(recordings: Sequence[Source], shortest: float) -> float:
    """Return the length (s) of the means to fit: the shortest, unless that makes more than MOST_BLOCKS of them."""
    return max(shortest, sum(recording.duration for recording in recordings) / MOST_BLOCKS)


def train_on_blocks(
    blocks: Blocks,
    recordings: Sequence[Source],
    channels: tuple[str, ...],
    settings: FeatureSettings,
    block: float,
    options: TrainingOptions,
    progress: Progress | None = None,
) -> Calibration:
    """Return the calibration fitted to blocks; recordings give the sample noise and the provenance."""
    _check_span(blocks, recordings)
    folds = cycle_folds(blocks)
    references = options.reference.of(channels, blocks.values)
    filtered = options.filter is not FilterMode.OFF
    stamps, samples = spread_samples(recordings[0], channels) if filtered else _NOTHING
    fitted = []
    for column, name in enumerate(channels):
        target = blocks.values[:, column] - references[column]
        fit = _ChannelFit(options, blocks.features, target, folds, channel_seed(options.seed, name), block)
        noisy = stamps, samples[:, column] if filtered else samples
        fitted.append(fit.calibrate(name, float(references[column]), noisy, progress))
    return with_id(
        Calibration(
            sensor_id=sensor_id_of(recordings, options),
            features=settings,
            calibrated_range=CalibratedRange.of(blocks.features),
            channels=tuple(fitted),
            training=_provenance(recordings, options, block, folds),
        )
    )


@dataclass(frozen=True)
class _ChannelFit:
    """One channel's part of the training."""

    options: TrainingOptions
    features: Array
    target: Array
    folds: Folds
    seed: int
    block: float

    def calibrate(
        self, name: str, reference: float, samples: tuple[Stamps, Array], progress: Progress | None
    ) -> ChannelCalibration:
        """Return the calibration of the channel; samples: stamps (n,) and values (n,) that a filter is designed for."""
        noise = noise_of_means(self.target)
        fit = fit_drift(
            self.options.method,
            self.features,
            self.target,
            self.folds,
            seed=self.seed,
            noise=noise,
            settings=self.options.genetic,
            progress=None if progress is None else lambda generation, best: progress(name, generation, best),
        )
        residual = self.target - fit.drift.evaluate(self.features)
        error = ChannelError(float(np.sqrt(np.mean(residual**2))), noise, fit.cross_validated)
        stage = design_filter(
            self.options.filter,
            self.options.filter_time_constant,
            *samples,
            name,
            error=error.unseen,
            block=self.block,
        )
        return ChannelCalibration(name, fit.drift, reference, stage, error)


def choose_channels(recordings: Sequence[Source], wanted: tuple[str, ...] | None) -> tuple[str, ...]:
    """Return the channels to train: those wanted, or all that every recording has.

    Raises RefusedError for a channel that a recording lacks.
    """
    common = tuple(c for c in CHANNELS if all(c in recording.present for recording in recordings))
    if wanted is None:
        if not common:
            raise RefusedError(
                "the recordings have no channel in common: every channel is zero or declared "
                "absent, look at the accelerometer's topic"
            )
        return common
    for channel in wanted:
        for recording in recordings:
            if channel not in recording.present:
                held = ", ".join(recording.present) or "none"
                raise RefusedError(f"{recording.name} has no channel {channel} (it has {held}): change --channels")
    return wanted


def channel_seed(seed: int, channel: str) -> int:
    """Return a seed of its own for each channel, the same whichever others are trained beside it."""
    return int(np.random.SeedSequence([seed, CHANNELS.index(channel)]).generate_state(1)[0])


def _check_span(blocks: Blocks, recordings: Sequence[Source]) -> None:
    span = float(np.ptp(blocks.features[:, 0]))
    if span < SMALLEST_SPAN:
        names = ", ".join(recording.name for recording in recordings)
        raise RefusedError(
            f"{names}: the temperature changes by {span:.2g} °C only, there is no drift to learn: "
            "record over the range that the sensor will see"
        )


def _provenance(recordings: Sequence[Source], options: TrainingOptions, block: float, folds: Folds) -> dict[str, Any]:
    """Return what the file says of the training; no clock in it, so that equal training gives an equal id."""
    return {
        "tool": f"hgma_compensation {__version__}",
        "method": options.method.value,
        "seed": options.seed,
        "block": block,
        "reference": str(options.reference),
        "folds": f"{folds.count} folds of {folds.kind}",
        "recordings": [
            {
                "name": recording.name,
                "start": recording.start,
                "duration": recording.duration,
                "samples": recording.samples,
            }
            for recording in recordings
        ],
    }
