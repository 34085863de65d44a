"""The Kalman stage on an array, against a loop of filterpy over the same samples."""

import time

import numpy as np

from benchmarks.bench.given import Given
from benchmarks.bench.row import Result, Row, Target, alternate
from benchmarks.bench.samples import DENSITY, SEED, STILL
from hgma_compensation.kalman.design import reference_filter
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.kalman.stage import KalmanStage
from hgma_compensation.stamps import NANOSECONDS

GROUP, RIVAL = "filtering", "filterpy, predict and update"
RATE = 10_000.0
OURS, RIVALS = 1_000_000, 20_000
"""Samples that either filters in a repetition: filterpy is slow, and as slow on few samples as on many."""

NOISE = RandomWalkNoise.with_time_constant(white=DENSITY, seconds=1.0)


def measure(given: Given) -> Result:
    """Return the row of the filter stage."""
    random = np.random.default_rng(SEED)
    measured = STILL + DENSITY * np.sqrt(RATE) * random.standard_normal(OURS)
    stamps = np.arange(OURS, dtype=np.int64) * round(NANOSECONDS / RATE)

    def ours() -> float:
        stage = KalmanStage(FilterSettings(FilterMode.SMOOTH, NOISE), reference=STILL)
        start = time.perf_counter()
        stage.run(stamps, measured)
        seconds = time.perf_counter() - start
        if stage.openings:
            raise RuntimeError("the gate took noise for motion")
        given.say(f"filter: {1e9 * seconds / OURS:.1f} ns a sample")
        return OURS / seconds

    def rival() -> float:
        reference = reference_filter(NOISE, 1.0 / RATE, float(measured[0]))
        samples = measured[1 : RIVALS + 1, None, None]
        start = time.perf_counter()
        for sample in samples:
            reference.predict()
            reference.update(sample)
        return RIVALS / (time.perf_counter() - start)

    figures = alternate(given.repetitions, ours, rival)
    name = "smooth, 10 kHz, one channel, an array"
    return Result((Row(GROUP, name, "samples/s", RIVAL, *figures, Target(500.0, at_least=True)),))
