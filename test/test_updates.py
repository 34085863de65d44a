import json
from dataclasses import dataclass
from math import exp, inf

import numpy as np
import pytest
from builders import EPOCH, make_stamps
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.effects.memory import Bank, Coldness, LowPass, Play
from hgma_compensation.stamps import NANOSECONDS, to_nanoseconds
from hgma_compensation.temperature.track import TemperatureTrack
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.temperature.updates import POWER_OFF, Updates

SECOND, LATENCY, HORIZON = NANOSECONDS, NANOSECONDS // 20, 10.0
BACK = 20 * SECOND
MEMORY = Bank([LowPass((30.0, 900.0)), Play((2.0,)), LowPass((5.0,))])


def walk(count, seed=7):
    random = np.random.default_rng(seed)
    stamps = make_stamps(np.cumsum(random.choice([0.1, 0.5, 1.0, 90.0], count, p=[0.4, 0.3, 0.29, 0.01])))
    return stamps, 20.0 + np.cumsum(0.3 * random.standard_normal(count)), 0.02 * random.standard_normal(count)


def filled(stamps, temperature, rate, memory=MEMORY, **options):
    updates = Updates(memory, **options)
    updates.extend(stamps, temperature, rate)
    return updates


def at(*seconds):
    return make_stamps(np.array(seconds))


def ramped(state, seconds, before, after, time_constant):
    """Return a low-pass's state after the temperature has gone evenly from before to after."""
    behind = (after - before) / seconds * time_constant
    return after - behind + (state - before + behind) * exp(-seconds / time_constant)


def bits(updates, stamps):
    parts = (
        *updates.read(stamps, LATENCY, HORIZON),
        updates.read_earlier(stamps, BACK, LATENCY, HORIZON),
        updates.read_memory(stamps, LATENCY, HORIZON),
    )
    return b"".join(part.tobytes() for part in (*parts, updates.since_power_on(stamps, LATENCY)))


def test_memory_starts_in_equilibrium_and_is_advanced_at_each_update():
    updates = filled(at(0.0, 10.0, 30.0), [20.0, 25.0, 22.0], [0.0, 0.0, 0.0], LowPass((100.0,)))
    middle = ramped(20.0, 10.0, 20.0, 25.0, 100.0)
    state = [20.0, middle, ramped(middle, 20.0, 25.0, 22.0, 100.0)]
    read = updates.read_memory(at(-5.0, 0.0, 10.0, 30.0), 0, HORIZON)
    np.testing.assert_allclose(read[:, 0], [20.0, *state], rtol=1e-14)


def test_a_reading_goes_on_to_the_predicted_temperature_for_at_most_the_horizon_and_stores_nothing():
    updates = filled(at(0.0, 1.0), [20.0, 20.0], [0.0, 0.1], LowPass((100.0,)))
    before = bits(updates, at(1.0))
    read = updates.read_memory(at(5.0, 11.0, 500.0), 0, HORIZON)[:, 0]
    expected = [ramped(20.0, s, 20.0, 20.0 + 0.1 * s, 100.0) for s in (4.0, 10.0, 10.0)]
    np.testing.assert_allclose(read, expected, rtol=1e-14)
    assert bits(updates, at(1.0)) == before


def test_memory_is_told_temperatures_inside_the_limits_only():
    inside = filled(at(0.0, 10.0, 20.0), [0.0, 50.0, 0.0], [0.0] * 3)
    beyond = filled(at(0.0, 10.0, 20.0), [-40.0, 90.0, -7.0], [0.0] * 3, limits=(0.0, 50.0))
    stamps = at(-1.0, 0.0, 5.0, 10.0, 21.0)
    assert np.array_equal(beyond.read_memory(stamps, LATENCY, HORIZON), inside.read_memory(stamps, LATENCY, HORIZON))
    assert beyond.read(stamps, LATENCY, HORIZON)[0][0] == -40.0


def test_update_is_used_from_exactly_the_latency_on():
    updates = filled(at(0.0, 100.0, 101.0), [20.0, 30.0, 40.0], [0.0] * 3, Play((0.0,)))
    edge = EPOCH + 101 * SECOND + LATENCY
    state = updates.read_memory(np.array([edge - 1, edge]), LATENCY, HORIZON)
    np.testing.assert_array_equal(state, [[30.0], [40.0]])


def test_without_updates_there_is_no_state_and_no_power_on():
    updates = Updates(MEMORY)
    assert np.isnan(updates.read_memory(at(0.0, 1.0), LATENCY, HORIZON)).all()
    assert updates.since_power_on(at(0.0), LATENCY).tolist() == [0.0]
    assert Updates().read_memory(at(0.0), LATENCY, HORIZON).shape == (1, 0)


def test_a_silence_of_more_than_a_minute_is_a_power_on_and_the_memory_goes_on_through_it():
    longest = POWER_OFF / SECOND
    times = [0.0, 10.0, 10.0 + longest, 100.0 + longest]
    updates = filled(at(*times), [20.0, 20.0, 20.0, 30.0], [0.0] * 4, LowPass((100.0,)))
    since = updates.since_power_on(at(-3.0, 0.0, 10.0, 69.0, 90.0, 159.0, 160.0, 165.0), 0)
    np.testing.assert_allclose(since, [0.0, 0.0, 10.0, 69.0, 90.0, 159.0, 0.0, 5.0], atol=1e-12)
    assert updates.power_on == at(160.0)[0]
    state = updates.read_memory(at(160.0), 0, HORIZON)[0, 0]
    assert state == pytest.approx(ramped(20.0, 90.0, 20.0, 30.0, 100.0), rel=1e-14)


def test_after_a_power_on_no_update_before_it_is_used_though_the_first_be_younger_than_the_latency():
    updates = filled(at(0.0, 200.0, 200.02, 201.0), [20.0, 30.0, 31.0, 40.0], [0.1] * 4, Play((0.0,)))
    edge = EPOCH + 200 * SECOND
    stamps = np.array([edge - 1, edge, edge + LATENCY, edge + LATENCY + SECOND // 50])
    temperature, _, age = updates.read(stamps, LATENCY, 0.0)
    np.testing.assert_array_equal(temperature, [20.0, 30.0, 30.0, 31.0])
    np.testing.assert_allclose(age, [200.0, 0.0, 0.05, 0.05])
    np.testing.assert_array_equal(updates.read_memory(stamps, LATENCY, 0.0)[:, 0], temperature)


def test_an_earlier_temperature_is_steady_before_the_power_on_that_a_stamp_is_after():
    updates = filled(at(0.0, 10.0, 200.0, 210.0), [20.0, 21.0, 30.0, 31.0], [0.0] * 4)
    stamps = at(5.0, 15.0, 199.0, 200.0, 215.0, 215.0)
    earlier = updates.read_earlier(stamps, 12 * SECOND, 0, HORIZON)
    np.testing.assert_array_equal(earlier, [20.0, 20.0, 21.0, 30.0, 30.0, 30.0])
    assert updates.read_earlier(at(215.0), 4 * SECOND, 0, HORIZON).tolist() == [31.0]
    assert np.isnan(Updates().read_earlier(stamps, SECOND, 0, HORIZON)).all()


def test_a_silence_of_exactly_a_minute_lets_no_memory_cool():
    updates = filled(at(0.0, 60.0), [20.0, 20.0], [0.0] * 2, Coldness((100.0,)))
    assert updates.read_memory(at(60.0), 0, HORIZON)[0, 0] == pytest.approx(exp(-0.6), rel=1e-14)


def test_an_earlier_power_on_can_be_assumed_and_is_forgotten_with_the_rest():
    updates = Updates()
    updates.assume_power_on(EPOCH - 500 * SECOND)
    updates.append(EPOCH, 20.0, 0.0)
    assert updates.since_power_on(at(1.0), 0) == pytest.approx([501.0], rel=1e-15)
    updates.reset()
    updates.append(EPOCH, 20.0, 0.0)
    assert updates.since_power_on(at(1.0), 0).tolist() == [1.0]
    assert len(updates) == 1


@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 900),
    cut=st.integers(0, 900),
    keep=st.sampled_from([0, 40, 700]),
)
def test_pruned_or_restored_updates_read_alike_inside_their_window(seed, count, cut, keep):
    stamps, temperature, rate = walk(count, seed)
    cut = min(cut, count - 1)
    whole = filled(stamps, temperature, rate)
    pruned = filled(stamps[:cut], temperature[:cut], rate[:cut], keep=keep * SECOND + BACK)
    restored = Updates(MEMORY, keep=keep * SECOND + BACK)
    restored.restore(json.loads(json.dumps(pruned.snapshot(keep * SECOND + BACK), allow_nan=False)))
    for one in (pruned, restored):
        one.extend(stamps[cut:], temperature[cut:], rate[cut:])
        window = stamps[-1] + LATENCY - np.linspace(-30.0, keep, 40) * SECOND
        grid = np.maximum(window.astype(np.int64), stamps[0])
        assert bits(one, grid) == bits(whole, grid)
        assert (one.first, one.last, one.power_on) == (whole.first, whole.last, whole.power_on)


def test_a_snapshot_holds_the_reach_and_not_more():
    stamps, temperature, rate = walk(2000)
    updates = filled(stamps, temperature, rate)
    held = updates.snapshot(20 * SECOND)
    assert held["stamps"][1] > stamps[-1] - 20 * SECOND >= held["stamps"][0]


def test_a_snapshot_of_another_memory_does_not_fit():
    snapshot = filled(*walk(10)).snapshot(SECOND)
    with pytest.raises(ValueError, match="reshape"):
        Updates(LowPass((1.0,))).restore(snapshot)


@dataclass(frozen=True)
class Fragile:
    """A memory that overflows where time runs backwards."""

    size = 1

    def start(self, temperature):
        return temperature.copy()

    def advance(self, state, seconds, before, temperature):
        assert np.all(seconds >= 0.0)
        return temperature + (state - temperature) * np.exp(-1e3 * seconds)


def test_time_never_runs_backwards_for_a_memory():
    updates = filled(*walk(50), Fragile())
    updates.read_memory(np.arange(EPOCH - 3600 * SECOND, EPOCH + 60 * SECOND, SECOND), LATENCY, HORIZON)


def test_a_track_drives_the_memory_with_its_filtered_temperature():
    stamps, temperature, _ = walk(80)
    noise = TrendNoise(process=1e-6, measurement=4e-4)
    plain, track = TemperatureTrack(noise), TemperatureTrack(noise, memory=Play((0.0,)), limits=(-inf, inf))
    for one in (plain, track):
        one.extend(stamps, temperature)
    grid = stamps + to_nanoseconds(0.07)
    state = track.updates.read_memory(grid, LATENCY, HORIZON)
    np.testing.assert_array_equal(state[:, 0], plain.read(grid, LATENCY, HORIZON)[0])
    track.reset()
    track.extend(stamps[:1], [35.0])
    assert track.updates.read_memory(stamps[:1], LATENCY, HORIZON)[0, 0] == 35.0
