"""Forward gaps and corrected clocks in the Kalman stage."""

import numpy as np
import pytest
from builders import make_stamps

from hgma_compensation.kalman.course import filter_samples
from hgma_compensation.kalman.intervals import PAUSE
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.kalman.stage import KalmanStage
from hgma_compensation.stamps import NANOSECONDS

RATE, WHITE = 100.0, 0.3
SETTINGS = FilterSettings(FilterMode.SMOOTH, RandomWalkNoise.with_time_constant(WHITE, 20.0))
DEVIATION = WHITE * np.sqrt(RATE)


def at_rest(seconds, seed=1):
    stamps = make_stamps(np.asarray(seconds))
    return stamps, 9.81 + DEVIATION * np.random.default_rng(seed).standard_normal(len(stamps))


@pytest.mark.parametrize("gap", [0.5, 5.0, 50.0])
def test_a_pause_neither_opens_the_gate_nor_makes_one_sample_count_for_all(gap):
    before, after = np.arange(4000) / RATE, 40.0 + gap + np.arange(4000) / RATE
    for seed in range(5):
        stage = KalmanStage(SETTINGS, 9.81)
        stamps, values = at_rest(np.concatenate([before, after]), seed)
        outputs, _ = stage.run(stamps, values)
        assert stage.openings == 0
        assert np.abs(outputs[4000:4010] - 9.81).max() < 0.5 * DEVIATION


def test_a_lower_sampling_rate_is_learned_within_a_few_samples():
    seconds = np.concatenate([np.arange(2000) / 1000.0, 2.0 + np.arange(1, 1000) * 0.5])
    stamps, _ = at_rest(seconds)
    steps = np.diff(seconds, prepend=-0.001)
    values = 9.81 + WHITE / np.sqrt(steps) * np.random.default_rng(2).standard_normal(len(stamps))
    outputs, _ = KalmanStage(SETTINGS, 9.81).run(stamps, values)
    plain, _ = filter_samples(SETTINGS.noise, stamps, values)
    assert np.abs(outputs[2200:] - plain[2200:]).max() < 0.01


def test_uneven_steps_up_to_the_limit_are_the_plain_filter_bit_for_bit():
    random = np.random.default_rng(4)
    steps = random.uniform(0.01, 0.01 * (PAUSE - 0.1), 500)
    stamps = make_stamps(np.cumsum(steps))
    values = 9.81 + WHITE / np.sqrt(steps) * random.standard_normal(500)
    outputs, _ = KalmanStage(SETTINGS, 9.81).run(stamps, values)
    assert outputs.tobytes() == filter_samples(SETTINGS.noise, stamps, values)[0].tobytes()


def test_after_a_clock_that_was_set_back_the_level_goes_on():
    stamps, values = at_rest(np.arange(6000) / RATE)
    stage, steady = KalmanStage(SETTINGS, 9.81), KalmanStage(SETTINGS, 9.81)
    stage.run(stamps[:4000], values[:4000])
    back = 7 * NANOSECONDS
    stage.set_back(int(stamps[4000]) - back)
    outputs, _ = stage.run(stamps[4000:] - back, values[4000:])
    expected, _ = steady.run(stamps, values)
    assert np.abs(outputs - expected[4000:]).max() < 0.05 * DEVIATION
