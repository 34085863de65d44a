import numpy as np
import pytest
from builders import make_stamps
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.kalman.course import filter_samples
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.kalman.stage import KalmanStage

NOISE = RandomWalkNoise(white=0.3, walk=0.05)
SMOOTH = FilterSettings(FilterMode.SMOOTH, NOISE)
BIAS = FilterSettings(FilterMode.BIAS, RandomWalkNoise.with_time_constant(0.3, 60.0), initial_bias=0.5)
REFERENCE = 9.81
SEED = 20190725
RATE = 10.0
DEVIATION = NOISE.white * np.sqrt(RATE)


def quiet(count, seed=SEED):
    random = np.random.default_rng(seed)
    return make_stamps(np.arange(count) / RATE), REFERENCE + DEVIATION * random.standard_normal(count)


def test_at_rest_it_is_the_plain_filter_bit_for_bit():
    stamps, values = quiet(5000)
    stage = KalmanStage(SMOOTH, REFERENCE)
    outputs, innovations = stage.run(stamps, values)
    plain, plain_innovations = filter_samples(NOISE, stamps, values)
    assert stage.openings == 0
    assert outputs.tobytes() == plain.tobytes()
    assert innovations.tobytes() == plain_innovations.tobytes()


@given(
    seed=st.integers(0, 2**32 - 1),
    cuts=st.lists(st.integers(0, 600), max_size=8),
    shock=st.floats(-500.0, 500.0),
    settings=st.sampled_from([SMOOTH, BIAS]),
)
def test_any_split_equals_the_batch_bit_for_bit(seed, cuts, shock, settings):
    random = np.random.default_rng(seed)
    stamps = make_stamps(np.cumsum(random.choice([-0.2, 0.0, 0.1, 0.3], 600, p=[0.02, 0.02, 0.9, 0.06])))
    values = REFERENCE + DEVIATION * random.standard_normal(600)
    values[100:120] += shock
    edges = sorted(cuts)
    stream = KalmanStage(settings, REFERENCE)
    parts = [stream.run(s, v) for s, v in zip(np.split(stamps, edges), np.split(values, edges), strict=True)]
    batch = KalmanStage(settings, REFERENCE).run(stamps, values)
    for got, expected in zip(zip(*parts, strict=True), batch, strict=True):
        assert np.concatenate(got).tobytes() == expected.tobytes()


@pytest.mark.parametrize("settings", [SMOOTH, BIAS])
@pytest.mark.parametrize("back", [0, 1, 300_000_000, 2_000_000_000])
def test_repeated_or_late_sample_corrects_nothing(settings, back):
    stamps, values = quiet(60)
    clean, _ = KalmanStage(settings, REFERENCE).run(stamps, values)
    late = np.insert(stamps, 40, stamps[39] - back)
    outputs, innovations = KalmanStage(settings, REFERENCE).run(late, np.insert(values, 40, 1000.0))
    assert innovations[40] > 900.0
    np.testing.assert_array_equal(np.delete(outputs, 40), clean)


@pytest.mark.parametrize("settings", [SMOOTH, BIAS])
def test_reset_starts_anew_from_the_first_sample(settings):
    stamps, values = quiet(400)
    stage = KalmanStage(settings, REFERENCE)
    stage.run(stamps, values + np.linspace(0.0, 100.0, 400))
    stage.reset()
    fresh = KalmanStage(settings, REFERENCE).run(stamps, values)
    for got, expected in zip(stage.run(stamps, values), fresh, strict=True):
        np.testing.assert_array_equal(got, expected)


def test_no_samples_give_no_outputs():
    outputs, innovations = KalmanStage(SMOOTH, REFERENCE).run(np.empty(0, dtype=np.int64), np.empty(0))
    assert len(outputs) == len(innovations) == 0


def test_a_million_samples_of_noise_do_not_open_the_gate():
    # Four sums beyond 6 σ: 2e-9 each and sample, correlated; 1e6 samples open it with p < 0.01.
    stamps, values = quiet(1_000_000)
    stage = KalmanStage(SMOOTH, REFERENCE)
    stage.run(stamps, values)
    assert stage.openings == 0


@pytest.mark.parametrize(("wander", "opens"), [(0.0, True), (0.7, False)])
def test_a_level_that_wanders_is_not_motion(wander, opens):
    stamps, values = quiet(20_000)
    # Faster than this filter follows, and 0.7 RMS: after 64 samples of σ = 0.95 that is 6 σ of their mean.
    values += np.sin(np.arange(20_000) / 150.0)
    noise = RandomWalkNoise.with_time_constant(NOISE.white, 600.0)
    stage = KalmanStage(FilterSettings(FilterMode.SMOOTH, noise, wander=wander), REFERENCE)
    stage.run(stamps, values)
    assert (stage.openings > 0) == opens


def test_smooth_goes_on_at_a_new_level_once_it_is_steady():
    stamps, values = quiet(4000)
    values[1000:] += 20.0
    stage = KalmanStage(SMOOTH, REFERENCE)
    outputs, _ = stage.run(stamps, values)
    assert not stage.open
    np.testing.assert_array_equal(outputs[1200:1900], values[1200:1900])
    # After 16 blocks of 64 calm samples the mean of 1024 is known to σ/√1024, and the filter goes on from there.
    assert abs(outputs[2300] - REFERENCE - 20.0) < 5.0 * DEVIATION / np.sqrt(1024.0)
    assert outputs[2300:].std() < 0.3 * DEVIATION


def test_it_returns_to_the_old_level_when_that_has_returned():
    stamps, values = quiet(3000)
    values[1000:1100] += 50.0
    stage = KalmanStage(FilterSettings(FilterMode.SMOOTH, RandomWalkNoise.with_time_constant(0.3, 600.0)), REFERENCE)
    outputs, _ = stage.run(stamps, values)
    assert not stage.open
    assert stage.openings == 1
    # Known from 1000 samples before and those after, not from the few that closed the gate.
    assert abs(outputs[1600:].mean() - REFERENCE) < 4.0 * DEVIATION / np.sqrt(1000.0)


def test_bias_is_learned_at_rest_and_kept_through_sustained_acceleration():
    stamps, values = quiet(60_000)
    values += 0.4
    values[40_000:50_000] += 20.0
    stage = KalmanStage(BIAS, REFERENCE)
    outputs, _ = stage.run(stamps, values)
    learned = values - outputs
    # The bias averages over 60 s: σ of the estimate is N / √(2·60 s).
    tolerance = 5.0 * 0.3 / np.sqrt(120.0)
    assert abs(learned[39_999] - 0.4) < tolerance
    np.testing.assert_array_equal(learned[40_010:50_000].round(9), learned[40_010].round(9))
    assert abs(learned[-1] - 0.4) < tolerance
    assert not stage.open


def test_bias_does_not_start_on_a_moving_sensor():
    stamps, values = quiet(3000)
    stage = KalmanStage(BIAS, REFERENCE)
    outputs, _ = stage.run(stamps, values + 50.0)
    assert stage.open
    np.testing.assert_array_equal(outputs, values + 50.0)


def test_vibration_passes_as_it_is():
    stamps, values = quiet(3000)
    shaken = values + np.where(np.arange(3000) >= 1500, 30.0 * np.sin(0.7 * np.arange(3000)), 0.0)
    stage = KalmanStage(SMOOTH, REFERENCE)
    outputs, is_open = np.empty(3000), np.empty(3000, dtype=bool)
    for k in range(3000):
        outputs[k], is_open[k] = stage.run(stamps[k : k + 1], shaken[k : k + 1])[0][0], stage.open
    opening = int(np.flatnonzero(is_open)[0])
    assert 1500 <= opening < 1510
    assert is_open[opening:].all()
    # What was withheld in the 1024 samples before the gate opened is given back in 192 parts where it is calm.
    withheld = (shaken - outputs)[opening - 1024 : opening].sum()
    assert (np.abs(outputs - shaken)[opening:] <= abs(withheld) / 192.0 + 1e-9).all()
    still_owed = abs((shaken - outputs)[opening - 1024 :].sum())
    assert still_owed < 0.7 * abs(withheld)
