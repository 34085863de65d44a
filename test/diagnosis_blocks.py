"""Blocks, noise and problems made by hand, for the tests of the diagnosis."""

from dataclasses import replace
from functools import cache

import numpy as np
from builders import LINEAR, make_calibration, make_recording, make_stamps, triangle, true_drift
from numpy.typing import NDArray
from scipy.linalg import toeplitz

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.diagnosis.prepare import prepare
from hgma_compensation.diagnosis.problem import Problem
from hgma_compensation.diagnosis.result import Diagnosis
from hgma_compensation.diagnosis.runs import make_run
from hgma_compensation.diagnosis.whitener import Whitener
from hgma_compensation.effects.memory import LowPass
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.temperature.features import FeatureSettings, Product
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.training.methods import Method
from hgma_compensation.training.train import TrainingOptions, train

Array = NDArray[np.float64]
CHANNEL = LINEAR[2]
DAY = 86_400.0
LASTS, RATE, THERMISTOR = 1800.0, 4.0, 0.005
NOISE = TrendNoise(process=1e-5, measurement=THERMISTOR**2)


def make_blocks_of(values: Array, seconds: float = 10.0, white: float = 1.0, runs: int = 1) -> Blocks:
    """Return blocks of these means (n,), in so many equally long runs of a day each."""
    count = len(values)
    run = np.arange(count) * runs // count
    first = np.arange(count) * 10
    stamps = make_stamps(run * DAY + np.arange(count) * seconds)
    return Blocks(run, stamps, np.asarray(values, dtype=np.float64), np.full(count, white), first, first + 10)


def no_whitening(count: int) -> Whitener:
    """Return the whitener of noise that is white already, of variance 1."""
    return Whitener((np.eye(count),), (np.arange(count),))


def flicker_covariance(count: int, block: float, strength: float) -> Array:
    """Return the covariance of flicker over equally spaced blocks: a sum of relaxations, three to the decade."""
    longest = 10.0 * (count - 1) * block
    exponents = np.arange(int(np.ceil(np.log10(longest / block) * 3.0)) + 1)
    times = block * 10.0 ** (exponents / 3.0)
    lags = np.arange(count)[:, None] * block
    return np.asarray(toeplitz(strength * np.log(10.0) / 3.0 * np.exp(-lags / times).sum(axis=1)))


def oven(seconds: Array, cycles: float) -> Array:
    """Return a temperature that ramps with sharp corners, °C, with a soak at every end."""
    return np.clip(triangle(seconds, LASTS / cycles, -30.0, 80.0), -10.0, 60.0)


def late(seconds: Array, temperature: Array, time_constant: float) -> Array:
    """Return the temperature through a low-pass that takes it to go evenly between samples."""
    low_pass = LowPass((time_constant,))
    states, state = np.empty_like(temperature), low_pass.start(temperature[:1])[None]
    for k in range(len(temperature)):
        before, now = temperature[max(k - 1, 0)], temperature[k]
        step = seconds[k] - seconds[max(k - 1, 0)]
        state = low_pass.advance(state, np.array([[step]]), np.array([[before]]), np.array([[now]]))
        states[k] = state[0, 0]
    return states


def lagging(seed: int, cycles: float, time_constant: float = 45.0, gain: float = 0.6, noise: float = 0.3) -> Recording:
    """Return a day of a sensor whose z drifts with the temperature and with a linear thermal lag."""
    recording = make_recording(
        seed, LASTS, RATE, 1.0, channels=(CHANNEL,), noise=noise, thermistor_noise=0.0, name=f"day {seed}"
    )
    random = np.random.default_rng(seed)
    seconds, thermistor = np.arange(int(LASTS * RATE)) / RATE, np.arange(int(LASTS))
    temperature = oven(seconds, cycles)
    values = np.zeros_like(recording.values)
    values[:, 2] = 9.81 + true_drift(temperature) + noise * random.standard_normal(len(seconds))
    values[:, 2] += gain * (late(seconds, temperature, time_constant) - temperature)
    measured = oven(thermistor, cycles) + THERMISTOR * random.standard_normal(len(thermistor))
    return replace(
        recording,
        stamps=make_stamps(seed * DAY + seconds),
        values=values,
        temperature=Series(make_stamps(seed * DAY + thermistor), measured),
    )


def settings() -> FeatureSettings:
    """Return the features that all made calibrations use."""
    return FeatureSettings(NOISE, product=Product.DELAY, delay=20.0, latency=0.05)


def calibration_of_z() -> Calibration:
    """Return a calibration of z whose drift model has yet to be fitted."""
    return replace(make_calibration(channels=(CHANNEL,)), features=settings())


def problem_of(recordings: list[Recording], block: float = 5.0) -> Problem:
    """Return the problem of z in recordings."""
    runs = [make_run(recording, NOISE) for recording in recordings]
    return prepare(runs, calibration_of_z(), CHANNEL, block, np.random.default_rng(1))


@cache
def lagging_days() -> tuple[Recording, ...]:
    """Return three days of a sensor with a large linear lag of 45 s."""
    return tuple(
        replace(lagging(day, cycles, gain=1.5), name=f"day {day}") for day, cycles in enumerate((2.0, 4.0, 3.0))
    )


@cache
def trained_before() -> Calibration:
    """Return a calibration trained on the first two of them that knows nothing of the lag."""
    return train(lagging_days()[:2], TrainingOptions(method=Method.POLYNOMIAL))


@cache
def diagnosis_of_days() -> Diagnosis:
    """Return the diagnosis of the first two days, judged on the third."""
    return diagnose(lagging_days()[:2], trained_before(), lagging_days()[2])


@cache
def lag_problem() -> Problem:
    """Return the problem of two days with a linear lag of 45 s."""
    return problem_of([lagging(1, 2.0), lagging(2, 4.0)])


@cache
def plain_problem() -> Problem:
    """Return the problem of two days without any effect."""
    return problem_of([lagging(1, 2.0, gain=0.0), lagging(2, 4.0, gain=0.0)])
