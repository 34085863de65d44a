"""All that the report of a training is made of, computed from the recordings and the finished calibration."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration
from hgma_compensation.drift.inputs import Array
from hgma_compensation.recording.source import Source
from hgma_compensation.report.search_record import SearchRecord
from hgma_compensation.training.blocks import Blocks, block_means
from hgma_compensation.training.comparison import Material, MethodResult, compare_methods
from hgma_compensation.training.folds import Folds, cycle_folds
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.methods import Method
from hgma_compensation.training.train import channel_seed

Advance = Callable[[str, Method], None]
"""Called with the channel and the method that was compared."""


@dataclass(frozen=True)
class TrainedChannel:
    """One channel. features: (n, 3) and target: (n,) drift of the means. results: of every method, the plainest first.

    method: that was chosen. search: (k,) best error on left-out folds after each generation.
    """

    calibration: ChannelCalibration
    features: Array
    target: Array
    results: tuple[MethodResult, ...]
    method: Method
    search: Array

    @property
    def name(self) -> str:
        """Name of the channel."""
        return self.calibration.name

    @property
    def chosen(self) -> MethodResult:
        """What the calibration holds."""
        return next(result for result in self.results if result.method is self.method)

    @property
    def best(self) -> MethodResult:
        """The method of least error on left-out folds."""
        return min(self.results, key=lambda result: result.cross_validated)

    @property
    def residual(self) -> Array:
        """What the fit leaves of the means, (n,)."""
        return self.target - self.calibration.drift.evaluate(self.features)


@dataclass(frozen=True)
class TrainingResult:
    """A finished training. blocks: what was fitted."""

    calibration: Calibration
    blocks: Blocks
    folds: Folds
    channels: tuple[TrainedChannel, ...]
    settings: GeneticSettings


def training_result(
    recordings: Sequence[Source],
    calibration: Calibration,
    settings: GeneticSettings,
    search: SearchRecord,
    advance: Advance | None = None,
) -> TrainingResult:
    """Return what the recordings say of the calibration that was trained on them, with all methods compared.

    settings: of the genetic search. search: what was heard of it while it trained.
    """
    blocks = block_means(recordings, calibration.names, calibration.features, float(calibration.training["block"]))
    folds = cycle_folds(blocks)
    channels = tuple(
        _channel(calibration, column, blocks, folds, settings, search, advance)
        for column in range(len(calibration.channels))
    )
    return TrainingResult(calibration, blocks, folds, channels, settings)


def _channel(
    calibration: Calibration,
    column: int,
    blocks: Blocks,
    folds: Folds,
    settings: GeneticSettings,
    search: SearchRecord,
    advance: Advance | None,
) -> TrainedChannel:
    channel = calibration.channels[column]
    method = Method(calibration.training["method"])
    seed = channel_seed(int(calibration.training["seed"]), channel.name)
    target = np.asarray(blocks.values[:, column] - channel.reference)
    material = Material(blocks.features, target, folds, channel.error.noise, seed, settings)
    results = []
    for result in compare_methods(
        material,
        chosen=(method, channel.drift),
        search=lambda number, best: search.add(channel.name, number, best),
    ):
        results.append(result)
        if advance is not None:
            advance(channel.name, result.method)
    timed = [
        replace(result, seconds=search.seconds(channel.name)) if result.seconds is None else result
        for result in results
    ]
    return TrainedChannel(channel, blocks.features, target, tuple(timed), method, search.errors(channel.name))
