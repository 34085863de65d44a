from dataclasses import replace

import numpy as np
import pytest
from builders import EPOCH, make_recording

from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.features import FeatureSettings
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.training.blocks import FEWEST, block_means, group_means, noise_of_means

SEED = 20190725
SETTINGS = FeatureSettings(TrendNoise(1e-3, 1e-4), delay=20.0, prediction_horizon=10.0)
CHANNEL = CHANNELS[1]
SIGMA_PER_MEDIAN = 1.0 / (0.6745 * np.sqrt(6.0))


def test_group_means_are_means_in_increasing_order_of_the_index():
    random = np.random.default_rng(SEED)
    index, columns = random.choice([-3, 0, 7, 1000], 200), random.standard_normal((200, 3))
    expected = [columns[index == value].mean(axis=0) for value in (-3, 0, 7, 1000)]
    np.testing.assert_allclose(group_means(index, columns), expected, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("sigma", [1e-3, 2.0])
def test_noise_of_white_noise_is_its_standard_deviation(sigma):
    n = 20000
    values = sigma * np.random.default_rng(SEED).standard_normal(n)
    # √(1.36 / n) for a median of absolute values (Rousseeuw and Croux 1993), times √1.94 because second differences
    # of white noise are correlated: 1 + 2 (2/3)² + 2 (1/6)².
    assert noise_of_means(values) == pytest.approx(sigma, rel=4.0 * np.sqrt(1.36 * 1.94 / n))


def test_slow_drift_does_not_enter_the_noise():
    random = np.random.default_rng(SEED)
    white, time = random.standard_normal(5000), np.arange(5000.0)
    drift = 300.0 * np.sin(2.0 * np.pi * time / 5000.0) + 0.7 * time
    # A median moves by no more than its largest term does.
    most = SIGMA_PER_MEDIAN * np.abs(np.diff(drift, 2)).max()
    assert most < 1e-3
    assert abs(noise_of_means(white + drift) - noise_of_means(white)) <= most


def test_a_few_spikes_and_steps_hardly_enter_the_noise():
    random = np.random.default_rng(SEED)
    white = random.standard_normal(5000)
    spiky = white.copy()
    spiky[::500] += 1e6
    spiky[2750:] += 1e4
    # Ten spikes touch three second differences each and the step two: the median moves by 32 ranks at most.
    ranked = SIGMA_PER_MEDIAN * np.sort(np.abs(np.diff(white, 2)))
    middle = len(ranked) // 2
    assert ranked[middle - 32] <= noise_of_means(spiky) <= ranked[middle + 32]


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 5.0], [3.0, 3.0, 3.0]])
def test_noise_of_too_few_or_equal_values_is_zero(values):
    assert noise_of_means(np.array(values)) == 0.0


def test_block_means_are_means_of_their_samples():
    recording = make_recording(duration_s=300.0, accel_rate=10.0)
    blocks = block_means([recording], [CHANNEL, CHANNELS[0]], SETTINGS, 4.0)
    # The first 10 s are left out; the block that they cut through is shorter.
    assert len(blocks.time) == 300 // 4 - 2
    for k, rows in [(0, slice(100, 120)), (1, slice(120, 160)), (-1, slice(2960, 3000))]:
        expected = recording.values[rows][:, [1, 0]].mean(axis=0)
        np.testing.assert_allclose(blocks.values[k], expected, rtol=1e-13)
        assert blocks.time[k] == pytest.approx(np.mean(np.arange(3000)[rows] / 10.0), rel=1e-12)


def test_samples_before_settling_and_without_a_recent_thermistor_are_left_out():
    recording = make_recording(duration_s=300.0, accel_rate=10.0)
    seconds = (recording.temperature.stamps - EPOCH) / NANOSECONDS
    kept = (seconds >= 30.0) & ~((seconds > 100.0) & (seconds < 150.0))
    thermistor = Series(recording.temperature.stamps[kept], recording.temperature.values[kept])
    blocks = block_means([replace(recording, temperature=thermistor)], [CHANNEL], SETTINGS, 1.0)
    # Settled 10 s after the first sample at 30 s; stale from 10 s after the last one at 100 s until one at 150 s is
    # old enough to be used.
    expected = np.r_[np.arange(40, 111), np.arange(150, 300)]
    np.testing.assert_array_equal(np.floor(blocks.time), expected)


def test_settling_is_left_out_after_every_power_on():
    recording = make_recording(duration_s=300.0, accel_rate=10.0)
    seconds = (recording.temperature.stamps - EPOCH) / NANOSECONDS
    kept = (seconds <= 100.0) | (seconds >= 170.0)
    thermistor = Series(recording.temperature.stamps[kept], recording.temperature.values[kept])
    blocks = block_means([replace(recording, temperature=thermistor)], [CHANNEL], SETTINGS, 1.0)
    np.testing.assert_array_equal(np.floor(blocks.time), np.r_[np.arange(10, 111), np.arange(180, 300)])


def test_samples_that_are_not_finite_are_left_out():
    recording = make_recording(duration_s=300.0, accel_rate=10.0)
    values = recording.values.copy()
    values[1000:1010, 1], values[2000, 1], values[1500:1600, 0] = np.nan, np.inf, np.nan
    blocks = block_means([replace(recording, values=values)], [CHANNEL], SETTINGS, 1.0)
    np.testing.assert_array_equal(np.floor(blocks.time), np.r_[np.arange(10, 100), np.arange(101, 300)])
    assert np.isfinite(blocks.values).all()


def test_recordings_follow_one_another():
    pair = [make_recording(seed, duration_s=100.0, accel_rate=10.0) for seed in (1, 2)]
    both = block_means(pair, [CHANNEL], SETTINGS, 1.0)
    for number, recording in enumerate(pair):
        alone = block_means([recording], [CHANNEL], SETTINGS, 1.0)
        part = both.select(both.recording == number)
        np.testing.assert_array_equal(part.features, alone.features)
        np.testing.assert_array_equal(part.values, alone.values)
        np.testing.assert_array_equal(part.time, alone.time)


@pytest.mark.parametrize(("blocks", "refused"), [(FEWEST, False), (FEWEST - 1, True)])
def test_too_few_blocks_are_refused(blocks, refused):
    recording = make_recording(duration_s=10.0 + blocks, accel_rate=10.0)
    if refused:
        with pytest.raises(RefusedError, match=rf"^made: {blocks} means of 1 s .* at least {FEWEST} .*longer$"):
            block_means([recording], [CHANNEL], SETTINGS, 1.0)
    else:
        assert len(block_means([recording], [CHANNEL], SETTINGS, 1.0).time) == blocks


def test_recording_without_thermistor_is_refused():
    with pytest.raises(RefusedError, match="made holds no thermistor sample"):
        block_means([replace(make_recording(), temperature=Series.empty())], [CHANNEL], SETTINGS, 1.0)
