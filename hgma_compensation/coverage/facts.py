"""What is in a recording: rates, gaps, ramps, soaks, power-ons, vibration and shocks."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.coverage.reading import Reading
from hgma_compensation.coverage.result import ChannelFacts, RecordingFacts, ThermistorFacts
from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.diagnosis.prepare import NOISIER, SHOCK
from hgma_compensation.diagnosis.problem import Problem
from hgma_compensation.diagnosis.runs import Run, power_on_before, power_ons
from hgma_compensation.stamps import NANOSECONDS, Stamps
from hgma_compensation.temperature.track import TAKEN, TemperatureTrack
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.training.blocks import noise_of_means
from hgma_compensation.training.folds import TURN, turning_points
from hgma_compensation.training.train import SMALLEST_SPAN

Array = NDArray[np.float64]

STILL = 0.1
"""Share of the fastest ramp's rate below which the temperature counts as standing still."""

SHORTEST_SOAK = 300.0
"""s: less is a turning point."""

SHORTEST_RAMP = 0.05
"""Share of the temperature's span that a ramp covers at least."""

REACHED = 0.8
"""Quantile of the rates within a ramp that stands for it: its ends are rounded by all that the heat goes through."""

SAME_RATE = 1.2
"""Ratio up to which two ramps count as having the same rate."""

APART = 1.0
"""s between two shocks, at least."""

BEYOND_CHANCE = 5.0
"""Deviations of a block's own variance, which is known from a few samples only, that are no vibration."""


def recording_facts(reading: Reading, run: Run, blocks: Sequence[Blocks], noise: TrendNoise) -> RecordingFacts:
    """Return what is in a recording; blocks: of each of its present channels, in their order, in all runs."""
    recording, survey = reading.recording, reading.survey
    return RecordingFacts(
        name=recording.name,
        duration=recording.duration,
        samples=survey.samples,
        rate=survey.rate,
        gaps=survey.gaps,
        longest_gap=survey.longest_gap,
        averaged=reading.averaged,
        channels=tuple(_channel(reading, channel, own) for channel, own in zip(recording.present, blocks, strict=True)),
        thermistor=_thermistor(run, noise),
        inputs=tuple(name for name in ("temperature_2", "supply_voltage") if recording.has(name)),
    )


@dataclass(frozen=True)
class Happened:
    """What went on in the blocks that are learned from. rates: °C/min. hours: from the first to the last."""

    rates: tuple[float, ...]
    power_ons: int
    shocks: int
    vibrating: bool
    hours: float


def happened(problem: Problem) -> Happened:
    """Return what went on in the blocks of a problem."""
    scene, blocks = problem.scene, problem.scene.blocks
    rates: list[float] = []
    starts = hits = 0
    column = CHANNELS.index(scene.channel)
    for number, run in enumerate(scene.runs):
        rows = np.flatnonzero(blocks.run == number)
        if len(rows):
            seconds = (blocks.stamps[rows] - blocks.stamps[rows[0]]) * 1e-9
            rates += _ramps_and_soaks(seconds, problem.features[rows, 0], problem.features[rows, 1])[0]
            starts += len(np.unique(power_on_before(run, blocks.stamps[rows])))
            part = slice(int(blocks.first[rows].min()), int(blocks.last[rows].max()))
            acceleration = scene.acceleration[number].column(column)[part]
            hits += shocks(run.recording.stamps[part], acceleration, problem.survey.noise)
    rest = ~scene.moving
    vibrating = vibrates(blocks.white[rest], (blocks.last - blocks.first)[rest])
    hours = float(blocks.stamps.max() - blocks.stamps.min()) / NANOSECONDS / 3600.0
    return Happened(_distinct(rates), starts, hits, vibrating, hours)


def _channel(reading: Reading, channel: str, blocks: Blocks) -> ChannelFacts:
    column, recording = CHANNELS.index(channel), reading.recording
    values = recording.values[:, column]
    noise = noise_of_means(values)
    return ChannelFacts(
        name=channel,
        lowest=float(reading.survey.lowest[column]),
        highest=float(reading.survey.highest[column]),
        noise=noise * float(np.sqrt(reading.averaged)),
        clipped=reading.survey.clipped(channel),
        vibrating=vibrates(blocks.white, blocks.last - blocks.first),
        shocks=shocks(recording.stamps, values, noise),
    )


def vibrates(white: Array, samples: NDArray[np.int64]) -> bool:
    """Return whether the noise of blocks, their white variance (n,), changes by more than chance would have it.

    samples: (n,) in each block. A variance out of m successive differences has a relative deviation of √(3/m).
    """
    if not len(white):
        return False
    chance = 1.0 + BEYOND_CHANCE * float(np.sqrt(3.0 / max(np.median(samples), 1.0)))
    return bool(np.quantile(white, 0.98) > max(NOISIER, chance) * np.median(white))


def shocks(stamps: Stamps, values: Array, noise: float) -> int:
    """Return how often samples (n,) jump as a shock does, there and back within a second.

    stamps: (n,) ns. noise: of one sample.
    """
    jumps = np.flatnonzero(np.abs(np.diff(values)) > SHOCK * noise) if noise > 0.0 else np.empty(0, dtype=np.int64)
    if not len(jumps):
        return 0
    groups = np.split(jumps, np.flatnonzero(np.diff(stamps[jumps]) > APART * NANOSECONDS) + 1)
    # A step of the level jumps once; what comes back has a jump of the other sign.
    return sum(bool(np.ptp(np.sign(values[group + 1] - values[group]))) for group in groups)


def _thermistor(run: Run, noise: TrendNoise) -> ThermistorFacts:
    series = run.recording.temperature
    track = TemperatureTrack(noise)
    track.extend(series.stamps.tolist(), series.values.tolist())
    smoothed = run.smoothed
    seconds = (smoothed.stamps - smoothed.stamps[0]) / NANOSECONDS
    rates, soaks, sweeps = ramps_and_soaks(seconds, smoothed.temperature, smoothed.rate)
    return ThermistorFacts(
        samples=len(series.stamps),
        rate=float(NANOSECONDS / max(np.median(np.diff(series.stamps)), 1.0)),
        noise=float(np.sqrt(noise.measurement)),
        bad={sample.value: count for sample, count in track.counts.items() if sample not in TAKEN},
        lowest=float(smoothed.temperature.min()),
        highest=float(smoothed.temperature.max()),
        rates=rates,
        soaks=soaks,
        sweeps=sweeps,
        power_ons=len(power_ons(smoothed.stamps)),
    )


def ramps_and_soaks(
    seconds: Array, temperature: Array, rate: Array
) -> tuple[tuple[float, ...], tuple[float, ...], int]:
    """Return the rates of the ramps (°C/min, each once, ascending), the lengths of soaks (s), and the sweeps.

    seconds, temperature (°C), rate (°C/s): (n,) of the smoothed thermistor.
    """
    rates, soaks, sweeps = _ramps_and_soaks(seconds, temperature, rate)
    return _distinct(rates), soaks, sweeps


def _ramps_and_soaks(seconds: Array, temperature: Array, rate: Array) -> tuple[list[float], tuple[float, ...], int]:
    """Return the same with the rate of each ramp."""
    span = float(np.ptp(temperature))
    if span < SMALLEST_SPAN:
        return [], (float(seconds[-1] - seconds[0]),), 0
    still = np.abs(rate) < STILL * np.quantile(np.abs(rate), 0.95)
    found: list[float] = []
    soaks: list[float] = []
    for part in np.split(np.arange(len(seconds)), np.flatnonzero(np.diff(np.sign(rate) * ~still) != 0) + 1):
        length = float(seconds[part[-1]] - seconds[part[0]])
        if still[part[0]]:
            soaks += [length] if length >= SHORTEST_SOAK else []
        elif abs(temperature[part[-1]] - temperature[part[0]]) >= SHORTEST_RAMP * span:
            found.append(60.0 * float(np.quantile(np.abs(rate[part]), REACHED)))
    return found, tuple(soaks), len(turning_points(temperature, TURN * span)) + 1


def _distinct(rates: Sequence[float]) -> tuple[float, ...]:
    """Return one rate, the median, for each group of rates that follow each other within SAME_RATE."""
    ordered = np.sort(rates)
    if not len(ordered):
        return ()
    groups = np.split(ordered, np.flatnonzero(ordered[1:] > SAME_RATE * ordered[:-1]) + 1)
    return tuple(float(np.median(group)) for group in groups)
