from itertools import pairwise

import numpy as np
import pytest
from builders import LINEAR, make_recording, make_stamps
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.coverage.facts import ramps_and_soaks, shocks, vibrates
from hgma_compensation.coverage.reading import reading_of
from hgma_compensation.coverage.samples import SampleSurvey
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.streamed import survey as survey_bag
from hgma_compensation.topics import TopicNames

Z = LINEAR[2]


def values_of(z):
    values = np.zeros((len(z), 6))
    values[:, 2] = z
    return values


def told(survey):
    return (
        survey.samples,
        survey.gaps,
        survey.longest_gap,
        survey.lowest.tolist(),
        survey.highest.tolist(),
        [survey.clipped(channel) for channel in LINEAR],
    )


@given(st.lists(st.integers(1, 399), max_size=6), st.integers(0, 10))
def test_windows_change_nothing(cuts, seed):
    random = np.random.default_rng(seed)
    z = np.clip(random.standard_normal(400), -1.0, 1.5)
    stamps = make_stamps(np.arange(400) * 0.1 + 5.0 * (np.arange(400) > 250))
    whole, parts = SampleSurvey(), SampleSurvey()
    whole.add(stamps, values_of(z))
    # The interval is read off the first window, which two samples are enough for.
    bounds = [0, *sorted({max(2, cut) for cut in cuts}), 400]
    for a, b in pairwise(bounds):
        parts.add(stamps[a:b], values_of(z[a:b]))
    assert told(parts) == told(whole)
    assert whole.gaps == 1
    assert whole.longest_gap == pytest.approx(5.1)


def test_samples_at_a_limit_are_counted_and_those_of_a_quiet_sensor_are_not():
    wave = 30.0 * np.sin(np.arange(2000) / 50.0) + 0.1 * np.random.default_rng(1).standard_normal(2000)
    for z, count in ((np.minimum(wave, 20.0), int(np.sum(wave >= 20.0))), (wave, 0), (np.round(wave / 40.0), 0)):
        survey = SampleSurvey()
        survey.add(make_stamps(np.arange(len(z)) * 0.1), values_of(z))
        assert survey.clipped(Z) == count


def test_not_finite_samples_are_no_extremes():
    survey = SampleSurvey()
    survey.add(make_stamps(np.arange(4) * 0.1), values_of(np.array([1.0, np.nan, np.inf, 2.0])))
    assert (survey.lowest[2], survey.highest[2]) == (1.0, 2.0)


def test_a_long_recording_is_averaged(tmp_path):
    recording = make_recording(duration_s=120.0, cycles=1.0)
    write_recording(recording, tmp_path / "bag")
    reading = reading_of(survey_bag(tmp_path / "bag", TopicNames()), most=len(recording.stamps) // 3)
    count = len(recording.stamps) // 3
    assert reading.averaged == 3
    assert reading.survey.samples == len(recording.stamps)
    means = recording.values[: 3 * count].reshape(count, 3, 6).mean(axis=1)
    np.testing.assert_allclose(reading.recording.values, means, rtol=1e-12)
    middles = recording.stamps[: 3 * count].reshape(count, 3)[:, 1]
    assert np.abs(reading.recording.stamps - middles).max() <= 1
    np.testing.assert_array_equal(reading.recording.temperature.values, recording.temperature.values)


def test_a_shock_comes_back_and_a_step_does_not():
    random = np.random.default_rng(2)
    stamps, z = make_stamps(np.arange(3000) * 0.1), random.standard_normal(3000)
    z[500:502] += 100.0
    z[1500] -= 80.0
    z[2000:] += 50.0
    assert shocks(stamps, z, 1.0) == 2
    assert shocks(stamps, random.standard_normal(3000), 1.0) == 0
    assert shocks(stamps, np.zeros(3000), 0.0) == 0


@pytest.mark.parametrize("samples", [10, 25, 100])
def test_noise_alone_does_not_vibrate_and_vibration_does(samples):
    random = np.random.default_rng(3)
    white = np.mean(np.diff(random.standard_normal((800, samples)), axis=1) ** 2, axis=1)
    count = np.full(800, samples)
    assert not vibrates(white, count)
    white[100:160] *= 10.0
    assert vibrates(white, count)


def test_ramps_and_soaks_are_those_of_the_oven():
    minutes = np.array([0, 10, 45, 60, 95, 115, 135])
    corners = np.array([25.0, 25.0, -10.0, -10.0, 60.0, 60.0, 20.0])
    seconds = np.arange(0.0, 135.0 * 60.0, 5.0)
    temperature = np.interp(seconds / 60.0, minutes, corners)
    rates, soaks, sweeps = ramps_and_soaks(seconds, temperature, np.gradient(temperature, seconds))
    np.testing.assert_allclose(rates, [1.0, 2.0], rtol=0.02)
    np.testing.assert_allclose(np.array(soaks) / 60.0, [10.0, 15.0, 20.0], atol=0.3)
    assert sweeps == 3


def test_a_room_is_one_soak():
    seconds = np.arange(0.0, 3600.0, 5.0)
    temperature = 25.0 + 0.01 * np.sin(seconds)
    assert ramps_and_soaks(seconds, temperature, np.gradient(temperature, seconds)) == ((), (3595.0,), 0)
