from math import inf, nan

import numpy as np
import pytest
from builders import EPOCH, make_stamps

from hgma_compensation.stamps import NANOSECONDS, to_nanoseconds
from hgma_compensation.temperature.track import PLAUSIBLE_CELSIUS, TIME_JUMP, Sample, TemperatureTrack
from hgma_compensation.temperature.trend_filter import TrendNoise

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


def test_jump_back_beyond_the_limit_restarts():
    stamps, values = samples(60)
    track = filled(stamps, values + 15.0)
    earlier = stamps - (stamps[0] - (stamps[-1] - TIME_JUMP - 1))
    assert track.add(int(earlier[0]), float(values[0])) is Sample.RESTARTED
    track.extend(earlier[1:], values[1:])
    fresh = filled(earlier, values)
    grid = np.arange(earlier[0] - SECOND, earlier[-1] + 20 * SECOND, SECOND // 3)
    assert bits(track, grid) == bits(fresh, grid)
    assert track.first == earlier[0]
    assert track.counts == {Sample.USED: 119, Sample.RESTARTED: 1}


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
