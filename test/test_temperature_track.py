from math import inf, nan

import numpy as np
import pytest
from builders import EPOCH, make_stamps

from hgma_compensation.effects.memory import LowPass
from hgma_compensation.stamps import NANOSECONDS, to_nanoseconds
from hgma_compensation.temperature.track import PLAUSIBLE_CELSIUS, Sample, TemperatureTrack
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.time_jumps import TIME_JUMP

NOISE = TrendNoise(process=1e-6, measurement=4e-4)
SECOND, HORIZON = NANOSECONDS, 10.0
LATENCY = SECOND // 20


def samples(count, seed=7):
    random = np.random.default_rng(seed)
    stamps = make_stamps(np.cumsum(random.uniform(0.1, 1.9, count)))
    return stamps, 20.0 + np.cumsum(0.1 * random.standard_normal(count))


def filled(stamps, celsius, **options):
    track = TemperatureTrack(NOISE, **options)
    track.extend(stamps, celsius)
    return track


def bits(track, stamps, latency=LATENCY):
    return b"".join(part.tobytes() for part in track.read(np.asarray(stamps), latency, HORIZON))


BAD = [
    (lambda last: last, 20.0, Sample.REPEATED),
    (lambda last: last - 1, 20.0, Sample.OUT_OF_ORDER),
    (lambda last: last - TIME_JUMP, 20.0, Sample.OUT_OF_ORDER),
    (lambda last: 0, 20.0, Sample.NOT_STAMPED),
    (lambda last: -SECOND, nan, Sample.NOT_STAMPED),
    (lambda last: last + SECOND, nan, Sample.NOT_FINITE),
    (lambda last: last + SECOND, inf, Sample.NOT_FINITE),
    (lambda last: last - 100 * SECOND, -inf, Sample.NOT_FINITE),
    (lambda last: last + SECOND, np.nextafter(PLAUSIBLE_CELSIUS[1], inf), Sample.IMPLAUSIBLE),
    (lambda last: last + SECOND, np.nextafter(PLAUSIBLE_CELSIUS[0], -inf), Sample.IMPLAUSIBLE),
    (lambda last: last - 100 * SECOND, 300.0, Sample.IMPLAUSIBLE),
]


@pytest.mark.parametrize(("stamp_after", "celsius", "outcome"), BAD)
def test_bad_sample_is_named_counted_and_changes_nothing(stamp_after, celsius, outcome):
    stamps, values = samples(60)
    clean, disturbed = filled(stamps[:40], values[:40]), filled(stamps[:40], values[:40])
    assert disturbed.add(stamp_after(disturbed.last), celsius) is outcome
    assert disturbed.counts == {Sample.USED: 40, outcome: 1}
    clean.extend(stamps[40:], values[40:])
    disturbed.extend(stamps[40:], values[40:])
    grid = np.arange(stamps[0] - SECOND, stamps[-1] + 20 * SECOND, SECOND // 3)
    assert bits(disturbed, grid) == bits(clean, grid)
    assert (disturbed.first, disturbed.last) == (clean.first, clean.last)


@pytest.mark.parametrize("celsius", PLAUSIBLE_CELSIUS)
def test_limits_of_what_is_plausible_are_used(celsius):
    assert TemperatureTrack(NOISE).add(EPOCH, celsius) is Sample.USED


def test_a_jump_back_to_the_beginning_restarts():
    stamps, values = samples(60)
    track = filled(stamps, values + 15.0)
    assert track.add(int(stamps[0]), float(values[0])) is Sample.RESTARTED
    track.extend(stamps[1:], values[1:])
    fresh = filled(stamps, values)
    grid = np.arange(stamps[0] - SECOND, stamps[-1] + 20 * SECOND, SECOND // 3)
    assert bits(track, grid) == bits(fresh, grid)
    assert track.first == stamps[0]
    assert track.counts == {Sample.USED: 119, Sample.RESTARTED: 1}


def test_a_clock_that_is_set_back_moves_the_history_and_keeps_the_memory():
    stamps, back = EPOCH + np.arange(200) * SECOND, 30 * SECOND
    values = 20.0 + 0.05 * np.arange(200.0)
    corrected = filled(stamps[:150], values[:150], memory=LowPass((300.0,)))
    steady = filled(stamps, values, memory=LowPass((300.0,)))
    assert corrected.add(int(stamps[150]) - back, values[150]) is Sample.SET_BACK
    corrected.extend(stamps[151:] - back, values[151:])
    grid = np.arange(stamps[0], stamps[-1] + 5 * SECOND, SECOND // 3)
    assert bits(corrected, grid - back) == bits(steady, grid)
    for read in ("read_memory", "read_earlier"):
        arguments = (LATENCY, HORIZON) if read == "read_memory" else (SECOND, LATENCY, HORIZON)
        one, other = (getattr(t.updates, read)(g, *arguments) for t, g in ((corrected, grid - back), (steady, grid)))
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("wrong", [1, 30])
def test_a_clock_that_was_ahead_for_a_moment_is_forgotten(wrong):
    stamps = EPOCH + np.arange(200) * SECOND
    values = 20.0 + 0.05 * np.arange(200.0)
    track, ahead = filled(stamps[:100], values[:100]), stamps[100 : 100 + wrong] + 10**6 * SECOND
    track.extend(ahead, np.full(wrong, 21.0))
    track.add(int(ahead[-1]) + SECOND, np.nan)
    assert track.last == ahead[-1]
    assert track.add(int(stamps[100]), values[100]) is Sample.RECALLED
    track.extend(stamps[101:], values[101:])
    grid = np.arange(stamps[0], stamps[-1] + 5 * SECOND, SECOND // 3)
    assert bits(track, grid) == bits(filled(stamps, values), grid)
    assert not track.last_is_unusable(grid, LATENCY).any()


def test_a_clock_that_was_ahead_for_long_has_begun_a_new_time():
    stamps = EPOCH + np.arange(10) * SECOND
    track = filled(stamps, np.full(10, 20.0))
    track.extend(stamps[-1] + np.arange(100, 170) * SECOND, np.full(70, 20.0))
    assert track.add(int(stamps[-1]) + SECOND, 20.0) is Sample.SET_BACK


def test_a_jump_is_not_used_until_three_samples_agree():
    stamps = EPOCH + np.arange(30) * SECOND
    track = filled(stamps[:10], np.full(10, 20.0))
    outcomes = [track.add(int(stamp), 60.0) for stamp in stamps[10:13]]
    assert outcomes == [Sample.JUMPED, Sample.JUMPED, Sample.MOVED]
    assert track.add(int(stamps[13]), 60.0) is Sample.USED
    at = stamps[[9, 11, 13]] + LATENCY
    temperature, rate, _ = track.read(at, LATENCY, HORIZON)
    np.testing.assert_allclose(temperature, [20.0, 20.0, 60.0], atol=1e-9)
    np.testing.assert_allclose(rate, 0.0, atol=1e-9)
    assert track.last_is_unusable(at, LATENCY).tolist() == [False, True, False]


def test_a_single_spike_leaves_no_trace_once_it_is_over():
    stamps, values = EPOCH + np.arange(60) * SECOND, 20.0 + 0.01 * np.arange(60.0)
    spiked = np.where(np.arange(60) == 30, -40.0, values)
    track, clean = filled(stamps, spiked), filled(np.delete(stamps, 30), np.delete(values, 30))
    grid = np.arange(stamps[0], stamps[-1], SECOND // 3)
    assert bits(track, grid) == bits(clean, grid)
    assert track.counts[Sample.JUMPED] == 1


@pytest.mark.parametrize(("resolution", "stuck"), [(0.0, True), (0.001, True), (0.1, False)])
def test_a_thermistor_that_has_lost_its_noise_is_stuck_unless_its_resolution_explains_it(resolution, stuck):
    random = np.random.default_rng(5)
    noisy = 20.0 + 0.01 * random.standard_normal(50)
    values = np.concatenate([noisy, np.full(40, 20.3)])
    if resolution:
        values = resolution * np.round(values / resolution)
    stamps = EPOCH + np.arange(90) * SECOND
    track = filled(stamps, values)
    assert (track.counts[Sample.STUCK] > 0) == stuck
    assert track.last_is_unusable(stamps[-1:] + LATENCY, LATENCY)[0] == stuck
    assert track.unchanged(int(stamps[-1])) >= 39.0


def test_sample_is_used_from_exactly_the_latency_on():
    stamps, values = samples(30)
    track = filled(stamps, values)
    edge = stamps[-1] + LATENCY
    _, _, age = track.read(np.array([edge - 1, edge]), LATENCY, HORIZON)
    np.testing.assert_array_equal(age, [(edge - 1 - stamps[-2]) * 1e-9, LATENCY * 1e-9])


def test_prediction_up_to_the_horizon_then_hold():
    stamps, values = samples(30)
    track = filled(stamps, values)
    at = stamps[-1] + np.array([1, 5, 10, 11, 3600]) * SECOND
    temperature, rate, age = track.read(at, LATENCY, HORIZON)
    settled, slope, _ = track.read(stamps[-1:], 0, HORIZON)
    assert slope[0] != 0.0
    np.testing.assert_array_equal(age, [1.0, 5.0, 10.0, 11.0, 3600.0])
    np.testing.assert_array_equal(rate, np.full(5, slope[0]))
    np.testing.assert_array_equal(temperature, settled + slope * np.array([1.0, 5.0, 10.0, 10.0, 10.0]))


def test_at_a_power_on_the_filter_starts_anew_and_after_a_shorter_silence_it_goes_on():
    stamps, values = samples(60)
    for gap, anew in ((60 * SECOND, False), (60 * SECOND + 1, True)):
        later = stamps - stamps[0] + stamps[-1] + gap
        track, fresh = filled(stamps, values), filled(later, values)
        track.extend(later, values)
        grid = np.arange(later[0], later[-1], SECOND // 3)
        assert (bits(track, grid) == bits(fresh, grid)) is anew
        assert bool(track.read(later[:1], LATENCY, HORIZON)[1][0] == 0.0) is anew


def test_before_the_first_sample():
    at = np.array([EPOCH - 3600 * SECOND, EPOCH - 1])
    temperature, rate, age = TemperatureTrack(NOISE).read(at, LATENCY, HORIZON)
    assert np.isnan(temperature).all()
    assert not rate.any()
    assert np.isinf(age).all()
    track = filled([EPOCH, EPOCH + SECOND], [20.0, 25.0])
    temperature, rate, age = track.read(at, LATENCY, HORIZON)
    np.testing.assert_array_equal(temperature, [20.0, 20.0])
    assert not rate.any()
    assert np.isinf(age).all()


def test_first_sample_alone_is_used_from_its_own_stamp_on():
    track = filled([EPOCH, EPOCH + LATENCY // 2], [20.0, 25.0])
    temperature, rate, age = track.read(EPOCH + np.array([0, LATENCY]), LATENCY, HORIZON)
    np.testing.assert_array_equal(temperature, [20.0, 20.0])
    np.testing.assert_array_equal(age, [0.0, LATENCY * 1e-9])
    assert not rate.any()


def test_reset_forgets_samples_and_keeps_counts():
    track = filled(*samples(30))
    track.reset()
    assert (track.first, track.last, track.counts[Sample.USED]) == (None, None, 30)
    assert np.isnan(track.read(np.array([EPOCH]), LATENCY, HORIZON)[0]).all()


@pytest.mark.parametrize("keep", [0.0, 30.0, 700.0])
def test_trimmed_track_reads_alike_inside_its_window_and_stays_small(keep):
    stamps, values = samples(6000)
    whole, trimmed = TemperatureTrack(NOISE), TemperatureTrack(NOISE, keep=keep)
    window = to_nanoseconds(keep)
    inside = np.arange(len(stamps)) - np.searchsorted(stamps, stamps - window) + 1
    # Doubled only while half of the room is in use, never below the 256 it starts with.
    most = max(256, 4 * (int(inside.max()) + 1)) * (8 + 8 + 16)
    for number, (stamp, value) in enumerate(zip(stamps.tolist(), values.tolist(), strict=True)):
        whole.add(stamp, value)
        trimmed.add(stamp, value)
        grid = np.linspace(stamp - window, stamp, 5).astype(np.int64) + LATENCY
        if number:
            assert bits(trimmed, np.maximum(grid, stamps[0])) == bits(whole, np.maximum(grid, stamps[0]))
        assert (
            sum(part.nbytes for part in vars(trimmed.updates._table).values() if isinstance(part, np.ndarray)) <= most
        )
