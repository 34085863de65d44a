"""The augmented calibration: drift model and gains fitted again, to what the node will see."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration, ChannelError
from hgma_compensation.channels import columns_of
from hgma_compensation.diagnosis.baseline import regressors
from hgma_compensation.diagnosis.problem import State
from hgma_compensation.diagnosis.scene import Scene
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.hysteresis import Hysteresis
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.pipeline.pipeline import CHUNK, Pipeline
from hgma_compensation.recording.compensated_bag import feed
from hgma_compensation.temperature.features import read_features
from hgma_compensation.training.blocks import noise_of_means

Array = NDArray[np.float64]


def causal_means(
    calibration: Calibration, channel: str, effects: Sequence[Effect], scene: Scene, number: int
) -> tuple[Array, list[Array]]:
    """Return features (n, 3) and columns (n, k) of each effect, as the node forms them, averaged over a run's blocks.

    Where the scene is carried, memories go on from the runs before.
    """
    run, blocks = scene.runs[number], scene.blocks
    idle = tuple(AppliedEffect(channel, effect, np.zeros(effect.count)) for effect in effects)
    pipeline = Pipeline(replace(calibration, effects=idle))
    recording, rows = run.recording, np.flatnonzero(blocks.run == number)
    for one in scene.runs[0 if scene.carried else number : number + 1]:
        feed(pipeline, one.recording)
    sums = [np.zeros((len(rows), 3)), *(np.zeros((len(rows), effect.count)) for effect in effects)]
    counts = np.zeros(len(rows))
    for start in range(0, len(recording.stamps), CHUNK):
        part = slice(start, min(start + CHUNK, len(recording.stamps)))
        columns = _causal_columns(pipeline, recording.stamps[part], np.nan_to_num(recording.values[part]))
        first = np.clip(blocks.first[rows] - part.start, 0, part.stop - part.start)
        last = np.clip(blocks.last[rows] - part.start, 0, part.stop - part.start)
        counts += last - first
        for total, column in zip(sums, columns, strict=True):
            running = np.vstack([np.zeros(column.shape[1]), np.cumsum(column, axis=0)])
            total += running[last] - running[first]
    means = [total / np.maximum(counts, 1.0)[:, None] for total in sums]
    return means[0], means[1:]


def _causal_columns(pipeline: Pipeline, stamps: NDArray[np.int64], imu: Array) -> list[Array]:
    calibration = pipeline.calibration
    features = read_features(pipeline.track, calibration.features, stamps).values
    unknown = np.isnan(features[:, 0])
    known = np.where(unknown[:, None], calibration.calibrated_range.middle, features)
    clamped = calibration.calibrated_range.clamp(known)
    acceleration = imu.copy()
    drift = np.stack([channel.drift.evaluate(clamped) for channel in calibration.channels], axis=1)
    acceleration[:, columns_of(calibration.names)] -= drift
    at = pipeline.inputs.conditions(stamps, clamped, unknown, acceleration)
    return [clamped, *pipeline.stage.columns(at, pipeline.inputs.memory(stamps, unknown))]


def as_left(state: State) -> tuple[Effect, ...]:
    """Return the effects as a calibration hands them on.

    A pipeline begins without a past. Where the recordings say that the material has one, plays begin where the last
    recording left them.
    """
    scene = state.problem.scene
    if not scene.carried:
        return state.effects
    return tuple(_left(effect, scene) if isinstance(effect, Hysteresis) else effect for effect in state.effects)


def _left(effect: Hysteresis, scene: Scene) -> Hysteresis:
    last = int(scene.blocks.run.max())
    return _stood(effect, scene.states_about(effect)[last][1], float(scene.runs[last].smoothed.temperature[-1]))


def _stood(effect: Hysteresis, state: Array, temperature: float) -> Hysteresis:
    """Return the effect whose plays stood at ``state`` (m,), on average, when the temperature was that (°C)."""
    offset = np.mean((state - temperature) / np.array(effect.memory().thresholds))
    return replace(effect, before=temperature, offset=float(np.clip(offset, -1.0, 1.0)))


def augmented(calibration: Calibration, channel: str, state: State) -> tuple[Calibration, Array]:
    """Return the calibration with a channel's drift model and effects replaced, and the levels of real input (m,).

    The weights are fitted to the features and columns that the node will form, under the noise of the state.
    """
    problem, scene = state.problem, state.problem.scene
    effects = as_left(state)
    parts = [causal_means(calibration, channel, state.effects, scene, number) for number in range(len(scene.runs))]
    features = np.concatenate([part[0] for part in parts])
    columns = [np.concatenate([part[1][i] for part in parts]) for i in range(len(effects))]
    base = regressors(problem.network, features)
    known = np.hstack([base, problem.inputs, *columns])
    weights, _ = state.solve(known)
    old = next(c for c in calibration.channels if c.name == channel)
    size, levels = base.shape[1], problem.inputs.shape[1]
    gains = np.split(weights[size + levels :], np.cumsum([c.shape[1] for c in columns])[:-1]) if columns else []
    network = problem.network
    count = len(network.centres)
    drift = RadialBasisDrift(
        network.scaling,
        network.centres,
        network.widths,
        weights[:count],
        float(weights[count]) - old.reference,
        weights[count + 1 : size],
    )
    residual = problem.values - known @ weights
    fit = float(np.sqrt(np.mean(residual**2)))
    error = ChannelError(fit, noise_of_means(residual), None)
    new = replace(old, drift=drift, error=error, filter=_quieter(old.filter, old.error, error))
    applied = tuple(AppliedEffect(channel, effect, gain) for effect, gain in zip(effects, gains, strict=True))
    return (
        replace(
            calibration,
            channels=tuple(new if c.name == channel else c for c in calibration.channels),
            effects=(*(e for e in calibration.effects if e.channel != channel), *applied),
        ),
        weights[size : size + levels],
    )


def _quieter(settings: FilterSettings, before: ChannelError, after: ChannelError) -> FilterSettings:
    """Return the filter's settings with the part of the level's wander taken away that is explained now."""
    if settings.mode is FilterMode.OFF:
        return settings
    explained = max(before.unseen**2 - before.noise**2, 1e-300)
    left = max(after.fit**2 - after.noise**2, 0.0)
    return replace(settings, wander=settings.wander * min(1.0, float(np.sqrt(left / explained))))
