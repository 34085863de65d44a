"""``check``: recordings in; what they can and cannot identify out."""

from collections.abc import Callable, Sequence

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.coverage.facts import happened, recording_facts
from hgma_compensation.coverage.judge import OF_DRIFT, OF_NOISE, Judge
from hgma_compensation.coverage.look_alikes import look_alikes
from hgma_compensation.coverage.provisional import provisional
from hgma_compensation.coverage.reading import Reading
from hgma_compensation.coverage.result import ChannelCheck, Check, RecordingFacts
from hgma_compensation.coverage.sensitivity import Sensitivity
from hgma_compensation.diagnosis.baseline import regressors
from hgma_compensation.diagnosis.blocks import make_blocks
from hgma_compensation.diagnosis.cross_validation import sweeps
from hgma_compensation.diagnosis.diagnose import SHORTEST_BLOCK
from hgma_compensation.diagnosis.prepare import prepare
from hgma_compensation.diagnosis.problem import State, without_rows
from hgma_compensation.diagnosis.recordings import Material, arrange
from hgma_compensation.diagnosis.runs import Run, make_run
from hgma_compensation.effects.registry import kinds
from hgma_compensation.errors import RefusedError
from hgma_compensation.training.blocks import FEWEST
from hgma_compensation.training.linear_algebra import one_thread
from hgma_compensation.training.train import block_length, choose_channels

Progress = Callable[[str], None]
"""Called with the name of each channel before it is judged."""


@one_thread()
def check(
    readings: Sequence[Reading],
    *,
    calibration: Calibration | None = None,
    holdout: Reading | None = None,
    channels: tuple[str, ...] | None = None,
    effects: Sequence[str] | None = None,
    seed: int = 1,
    progress: Progress | None = None,
) -> Check:
    """Return what a diagnosis of the recordings could name, the hold-out left out as ``diagnose`` does.

    effects: names of kinds, None for all. seed: of the surrogates. Raises RefusedError where a recording lacks a
    thermistor or a channel that is wanted, or is too short to say anything.
    """
    every = [*readings, *([holdout] if holdout else [])]
    recordings = [reading.recording for reading in every]
    names = choose_channels(recordings, channels or (calibration.names if calibration else None))
    block = block_length(recordings, SHORTEST_BLOCK)
    if calibration is not None:
        _check_calibration(calibration, names)
    model = calibration or provisional(recordings, names, block)
    material = arrange([reading.recording for reading in readings], holdout.recording if holdout else None)
    runs = [make_run(recording, model.features.noise) for recording in material.recordings]
    _check_range(runs, model)
    facts = tuple(_facts(reading, model, block) for reading in every)
    wanted = tuple(kinds()) if effects is None else tuple(effects)
    checked = []
    for name in names:
        if progress is not None:
            progress(name)
        checked.append(_channel(name, material, runs, model, block, facts, wanted, seed))
    return Check(facts, tuple(checked), material.holdout)


def _check_calibration(calibration: Calibration, names: Sequence[str]) -> None:
    for name in names:
        if name not in calibration.names:
            known = ", ".join(calibration.names)
            raise RefusedError(f"--channels {name}: the calibration has {known} only: leave --calibration out")


def _check_range(runs: Sequence[Run], model: Calibration) -> None:
    """Raise RefusedError where no recording comes into the calibrated range of the temperature."""
    low, high = float(model.calibrated_range.lower[0]), float(model.calibrated_range.upper[0])
    seen = np.concatenate([run.smoothed.temperature for run in runs])
    if not np.any((seen >= low) & (seen <= high)):
        raise RefusedError(
            f"the recordings span {seen.min():.1f} to {seen.max():.1f} °C, the calibration {low:.1f} to {high:.1f} °C: "
            "leave --calibration out"
        )


def _facts(reading: Reading, model: Calibration, block: float) -> RecordingFacts:
    run = make_run(reading.recording, model.features.noise)
    blocks = [make_blocks([run], channel, block) for channel in reading.recording.present]
    return recording_facts(reading, run, blocks, model.features.noise)


def _channel(
    name: str,
    material: Material,
    runs: Sequence[Run],
    model: Calibration,
    block: float,
    facts: Sequence[RecordingFacts],
    effects: Sequence[str],
    seed: int,
) -> ChannelCheck:
    random = np.random.default_rng([seed, CHANNELS.index(name)])
    whole = prepare(runs, model, name, block, random)
    problem = without_rows(whole, ~material.held_rows(whole.scene.blocks))
    if len(problem.values) < FEWEST:
        names = ", ".join(recording.name for recording in material.recordings)
        raise RefusedError(
            f"{names}: {len(problem.values)} means of {block:g} s of {name} at "
            f"rest to learn from, at least {FEWEST} are needed: record for longer"
        )
    sensitivity = Sensitivity.of(problem, random)
    drift = _drift_range(sensitivity.state)
    small = max(OF_NOISE * sensitivity.noise, OF_DRIFT * drift)
    inputs = frozenset.intersection(*(frozenset(one.inputs) for one in facts))
    averaged = max(one.averaged for one in facts)
    judge = Judge(sensitivity, happened(problem), inputs, averaged, sweeps(problem), small)
    checks = tuple(judge.effect(kinds()[effect], random) for effect in effects)
    pairs = look_alikes(sensitivity.points, effects)
    return ChannelCheck(name, sensitivity.noise, drift, small, judge.sweeps, checks, pairs)


def _drift_range(state: State) -> float:
    """Return the range of what the drift model carries, real acceleration that recurs left out."""
    weights, _ = state.fit()
    columns = regressors(state.problem.network, state.problem.features)
    return float(np.ptp(columns @ weights[: columns.shape[1]]))
