"""Builds the question of a channel out of recordings and a calibration."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.diagnosis.baseline import smooth_network
from hgma_compensation.diagnosis.blocks import SETTLING, Blocks, make_blocks
from hgma_compensation.diagnosis.inputs import Inputs, find_inputs
from hgma_compensation.diagnosis.medians import median_of
from hgma_compensation.diagnosis.noise_fit import thermistor_error
from hgma_compensation.diagnosis.problem import Problem, without_rows
from hgma_compensation.diagnosis.runs import Run, read_earlier, read_smoothed
from hgma_compensation.diagnosis.scene import Scene
from hgma_compensation.effects.effect import Survey
from hgma_compensation.pipeline.pipeline import CHUNK
from hgma_compensation.recording.sliced import in_parts
from hgma_compensation.recording.spooled import Spooled
from hgma_compensation.stamps import NANOSECONDS, Stamps
from hgma_compensation.temperature.features import FeatureSettings, Product
from hgma_compensation.training.blocks import white_noise

Array = NDArray[np.float64]


def smooth_features(run: Run, settings: FeatureSettings, stamps: Stamps) -> Array:
    """Return T, Ṫ and T·ΔT (n, 3) at stamps (n,) from the smoothed temperature."""
    temperature, rate = read_smoothed(run.smoothed, stamps)
    if settings.product is Product.DELAY:
        earlier = read_earlier(run, stamps, settings.delay)
    else:
        earlier = np.full(len(stamps), settings.reference_temperature)
    return np.column_stack([temperature, rate, temperature * (temperature - earlier)])


def features_at(runs: Sequence[Run], settings: FeatureSettings, blocks: Blocks) -> Array:
    """Return the features (n, 3) of all blocks."""
    features = np.empty((len(blocks), 3))
    for number, run in enumerate(runs):
        rows = blocks.run == number
        features[rows] = smooth_features(run, settings, blocks.stamps[rows])
    return features


def acceleration_of(run: Run, calibration: Calibration) -> Spooled:
    """Return the acceleration (samples, 6) less drift model and reference where a channel is calibrated."""
    recording, acceleration = run.recording, Spooled(len(CHANNELS))
    for part in in_parts(recording.samples, CHUNK):
        seen = smooth_features(run, calibration.features, recording.stamps[part])
        features, values = calibration.calibrated_range.clamp(seen), recording.values[part].copy()
        for channel in calibration.channels:
            values[:, CHANNELS.index(channel.name)] -= channel.drift.evaluate(features) + channel.reference
        acceleration.add(values)
    return acceleration


def prepare(
    runs: Sequence[Run],
    calibration: Calibration,
    channel: str,
    block: float,
    random: np.random.Generator,
    acceleration: tuple[Spooled, ...] | None = None,
) -> Problem:
    """Return the problem of one channel in runs.

    acceleration: that of each run, which is the same for all channels; formed where it is not given.
    Left out: blocks of motion that does not recur, and those outside of the calibrated range.
    """
    # Until the delay of ΔT has gone by since a power-on, the product says nothing of the sensor.
    blocks = make_blocks(runs, channel, block, max(SETTLING, calibration.features.delay))
    limits = calibration.calibrated_range
    seen = features_at(runs, calibration.features, blocks)
    features = limits.clamp(seen)
    if acceleration is None:
        acceleration = tuple(acceleration_of(run, calibration) for run in runs)
    model = next(c for c in calibration.channels if c.name == channel)
    inputs = find_inputs(blocks, blocks.values - model.drift.evaluate(features) - model.reference)
    ends = (float(limits.lower[0]), float(limits.upper[0]))
    scene = Scene(tuple(runs), blocks, ends, channel, acceleration, inputs.moving)
    problem = Problem(
        scene=scene,
        features=features,
        network=smooth_network(features[inputs.usable & limits.contains(seen)], CLOSEST),
        inputs=inputs.columns,
        block=block,
        thermistor=thermistor_error(runs[0], calibration.features.noise, block, random),
        survey=survey_of(runs, channel, blocks, features, inputs, block, acceleration),
        settings=calibration.features,
    )
    return without_rows(problem, inputs.usable & limits.contains(seen))


CLOSEST = 0.5
"""°C between the Gaussians of the static map, at least: a drift that bends faster is none."""

NOISIER = 2.0
"""Ratio of a block's noise to the typical one from which on something vibrates."""


SHOCK = 15.0
"""Deviations of a sample's noise between neighbours from which on there may have been a shock."""


def _differences(samples: Spooled, column: int, order: int) -> Iterator[Array]:
    """Yield the differences of the samples' column from one to the next, or of these, without their sign."""
    before = np.empty(0)
    for part in samples.parts():
        values = np.concatenate([before, part[:, column]])
        yield np.abs(np.diff(values, order))
        before = values[-order:]


def _noise(samples: Spooled, column: int) -> float:
    """Return the white noise of a sample, as ``noise_of_means`` does; 0 where no three finite ones are neighbours."""

    def finite() -> Iterator[Array]:
        return (part[np.isfinite(part)] for part in _differences(samples, column, 2))

    return white_noise(median_of(finite)) if any(len(part) for part in finite()) else 0.0


def _jump(samples: Spooled, column: int) -> float:
    """Return the largest step between samples that are finite."""
    return max((float(np.nanmax(part, initial=0.0)) for part in _differences(samples, column, 1)), default=0.0)


def survey_of(
    runs: Sequence[Run],
    channel: str,
    blocks: Blocks,
    features: Array,
    inputs: Inputs,
    block: float,
    acceleration: Sequence[Spooled],
) -> Survey:
    """Return what the runs span."""
    ends = [(int(s[:1][0]), int(s[-1:][0])) for s in (run.recording.stamps for run in runs)]
    first, last = min(a for a, _ in ends), max(b for _, b in ends)
    column = CHANNELS.index(channel)
    present = set(runs[0].recording.present).intersection(*(run.recording.present for run in runs))
    volts = [run.recording.supply_voltage.values for run in runs if len(run.recording.supply_voltage.values)]
    at_rest = blocks.white[~inputs.moving]
    noise = float(np.median([_noise(one, column) for one in acceleration]))
    return Survey(
        channel=channel,
        others=tuple(c for c in CHANNELS if c in present and c != channel),
        lowest=float(features[:, 0].min()),
        highest=float(features[:, 0].max()),
        duration=float(max((b - a) / NANOSECONDS for a, b in ends)),
        interval=block,
        ramp=float(np.quantile(np.abs(features[:, 1]), 0.95)),
        noise=noise,
        origin=first,
        voltage=float(np.median(np.concatenate(volts))) if volts else 0.0,
        lifetime=(last - first) / NANOSECONDS,
        vibration=bool(np.quantile(at_rest, 0.98) > NOISIER * np.median(at_rest)),
        inputs=bool(inputs.columns.shape[1]),
        shocks=any(_jump(one, column) > SHOCK * noise for one in acceleration),
    )
