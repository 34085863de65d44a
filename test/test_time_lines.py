"""Time that jumps: what becomes of the output, the filters and the memories."""

import numpy as np
import pytest
from builders import EPOCH, LINEAR, make_calibration, make_recording
from effect_calibrations import OFFERED, applied
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.channels import columns_of
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.registry import make
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.compensated import Compensated, joined
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.status import TemperatureStatus
from hgma_compensation.pipeline.stretches import Cut
from hgma_compensation.stamps import NANOSECONDS
from hgma_compensation.temperature.track import Sample

RECORDING = make_recording(duration_s=60.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)
VALUES = RECORDING.values[:, columns_of(LINEAR[2:])]
MEMORY_EFFECTS = ("stress_relaxation", "hysteresis", "warm_up", "post_shock_zero_shift", "vibration_rectification")


def calibration_with_memory(mode=FilterMode.SMOOTH):
    offered = {effect.name: effect for effect in OFFERED[LINEAR[2]]}
    random = np.random.default_rng(8)
    effects = [applied(LINEAR[2], offered[name], random) for name in MEMORY_EFFECTS]
    return make_calibration(channels=LINEAR[2:], mode=mode, effects=effects)


def events():
    """Return thermistor (None, stamp, value) and accelerometer (row, stamp, value) samples in the order of stamps."""
    series = RECORDING.temperature
    slow = [(None, *event) for event in zip(series.stamps.tolist(), series.values.tolist(), strict=True)]
    fast = list(zip(range(len(VALUES)), RECORDING.stamps.tolist(), VALUES[:, 0].tolist(), strict=True))
    return sorted(slow + fast, key=lambda event: (event[1], event[0] is not None))


def run(pipeline, happenings):
    """Give a pipeline the samples one by one and return the result of the accelerations."""
    parts = []
    for row, stamp, value in happenings:
        if row is None:
            pipeline.add_temperature(stamp, value)
        else:
            parts.append(pipeline.compensate(np.array([stamp]), np.array([[value]])))
    return joined(parts)


def assert_same_bits(one, other):
    for name in Compensated.FIELDS:
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name


@pytest.mark.parametrize("mode", list(FilterMode))
@pytest.mark.parametrize("lead", [-1.97, -0.27, 0.0, 0.33, 1.97])
def test_a_looping_bag_gives_the_same_output_whichever_topic_turns_first(mode, lead):
    rounds = 4
    arrivals = sorted(
        (number * 60.0 + (stamp - EPOCH) * 1e-9 - lead * (row is None), row is not None, (row, stamp, value))
        for number in range(rounds)
        for row, stamp, value in events()
    )
    pipeline = Pipeline(calibration_with_memory(mode), live=True)
    result = run(pipeline, [event for _, _, event in arrivals])
    assert pipeline.cuts == {Cut.ANEW: rounds - 1}
    count = len(RECORDING.stamps)
    for number in range(1, rounds):
        for name in Compensated.FIELDS:
            values = getattr(result, name)
            np.testing.assert_array_equal(values[number * count : (number + 1) * count], values[:count], name)


def test_a_recording_of_several_rounds_read_whole_is_compensated_round_by_round():
    calibration = calibration_with_memory()
    whole, once = Pipeline(calibration), Pipeline(calibration)
    for pipeline, rounds in ((whole, 3), (once, 1)):
        for _ in range(rounds):
            for row, stamp, celsius in events():
                if row is None:
                    pipeline.add_temperature(stamp, celsius)
    result = whole.compensate(np.tile(RECORDING.stamps, 3), np.tile(VALUES, (3, 1)))
    expected = once.compensate(RECORDING.stamps, VALUES)
    assert_same_bits(result, joined([expected] * 3))


@pytest.mark.parametrize("back", [6.0, 20.0])
@pytest.mark.parametrize("lag", [0.0, 1.0])
def test_a_clock_that_is_set_back_keeps_filters_and_memories(back, lag):
    """Both streams are stamped by one clock, which is set back at 40 s; the thermistor notices ``lag`` s later."""
    calibration = calibration_with_memory()
    steady = run(Pipeline(calibration, live=True), events())
    turned = EPOCH + 40 * NANOSECONDS
    happenings = [
        (row, stamp - round(back * NANOSECONDS) * (stamp >= turned + (row is None) * lag * NANOSECONDS), value)
        for row, stamp, value in events()
    ]
    pipeline = Pipeline(calibration, live=True)
    result = run(pipeline, happenings)
    assert pipeline.cuts == {Cut.SET_BACK: 1}
    after = slice(430, None)
    np.testing.assert_allclose(result.drift[after], steady.drift[after], atol=0.6)
    np.testing.assert_allclose(result.values[after], steady.values[after], atol=0.6)
    fresh = run(Pipeline(calibration, live=True), [e for e in events() if e[1] >= turned])
    assert np.abs(fresh.drift[30:] - steady.drift[after]).mean() > 5.0


def test_a_thermistor_whose_clock_alone_begins_anew_is_followed_once_it_has_caught_up():
    calibration = make_calibration(channels=LINEAR[2:])
    pipeline = Pipeline(calibration, live=True)
    run(pipeline, events())
    ahead = 100 * NANOSECONDS
    for stamp in range(EPOCH, EPOCH + 20 * NANOSECONDS, NANOSECONDS):
        pipeline.add_temperature(stamp, 20.0)
    still = pipeline.compensate(np.array([EPOCH + ahead]), np.zeros((1, 1)))
    assert TemperatureStatus(still.status[0]) is TemperatureStatus.STALE
    assert still.features[0, 0] != 20.0
    for stamp in range(EPOCH + ahead, EPOCH + 2 * ahead, NANOSECONDS):
        pipeline.add_temperature(stamp, 20.0)
    caught = pipeline.compensate(np.array([EPOCH + 2 * ahead - NANOSECONDS]), np.zeros((1, 1)))
    assert TemperatureStatus(caught.status[0]) is TemperatureStatus.OK
    assert caught.features[0, 0] == pytest.approx(20.0)


def test_a_thermistor_a_minute_ahead_changes_nothing():
    calibration = calibration_with_memory()
    happenings = events()
    order = sorted(happenings, key=lambda event: event[1] - 55 * NANOSECONDS * (event[0] is None))
    assert order != happenings
    assert_same_bits(run(Pipeline(calibration, live=True), order), run(Pipeline(calibration, live=True), happenings))


@pytest.mark.parametrize("ahead", [6, 30, 10**5])
@pytest.mark.parametrize("which", [None, 0], ids=["thermistor", "accelerometer"])
def test_one_stamp_from_the_future_leaves_no_trace(which, ahead):
    calibration, once = calibration_with_memory(), events()
    future = EPOCH + (30 + ahead) * NANOSECONDS
    place = next(
        i
        for i, event in enumerate(once)
        if event[1] > EPOCH + 30 * NANOSECONDS and (event[0] is None) == (which is None)
    )
    pipeline, clean = Pipeline(calibration, live=True), Pipeline(calibration, live=True)
    disturbed = run(pipeline, [*once[:place], (which, future, once[place][2]), *once[place:]])
    expected = run(clean, once)
    if which is None:
        assert pipeline.track.counts[Sample.RECALLED] == 1
        assert_same_bits(disturbed, expected)
        return
    assert pipeline.cuts[Cut.RECALLED] == 1
    row = once[place][0]
    np.testing.assert_array_equal(np.delete(disturbed.values, row, axis=0), expected.values)
    assert np.isfinite(disturbed.values).all()
    assert (TemperatureStatus(disturbed.status[row]) is TemperatureStatus.STALE) == (ahead > 10)


def test_a_shock_before_a_pause_leaves_its_shift_after_it():
    parameters = {"channel": LINEAR[2], "threshold": 50.0, "time_constant": 1000.0}
    effect = AppliedEffect(LINEAR[2], make("post_shock_zero_shift", parameters), np.array([0.01, 0.0]))
    pipeline = Pipeline(make_calibration(channels=LINEAR[2:], effects=[effect]), live=True)
    stamps = EPOCH + np.array([0, 1, 2, 3, 1000, 1001]) * NANOSECONDS
    values = np.array([9.81, 9.81, 1009.81, 9.81, 9.81, 9.81])[:, None]
    plain = Pipeline(make_calibration(channels=LINEAR[2:]), live=True)
    shift = pipeline.compensate(stamps, values).drift - plain.compensate(stamps, values).drift
    assert shift[-1, 0] == pytest.approx(10.0, rel=0.3)


@given(
    jumps=st.lists(
        st.tuples(st.integers(0, 300), st.sampled_from([-4000.0, -30.0, -6.0, -1.0, 70.0, 1e5])), max_size=5
    ),
    bad=st.lists(
        st.tuples(st.integers(0, 300), st.sampled_from([np.nan, np.inf, 1e9, 300.0, 90.0, -50.0])), max_size=6
    ),
    seed=st.integers(0, 2**16),
)
def test_whatever_stamps_and_temperatures_do_the_output_is_finite(jumps, bad, seed):
    random = np.random.default_rng(seed)
    clocks = {kind: np.zeros(300) for kind in (True, False)}
    for place, seconds in jumps:
        for kind in random.choice([True, False], random.integers(1, 3), replace=False):
            clocks[bool(kind)][place:] += seconds
    broken = dict(bad)
    pipeline = Pipeline(calibration_with_memory(), live=True)
    for number, (row, stamp, value) in enumerate(events()[:300]):
        moved = stamp + round(clocks[row is None][number] * NANOSECONDS)
        if row is None:
            pipeline.add_temperature(moved, broken.get(number, value))
        else:
            result = pipeline.compensate(np.array([moved]), np.array([[value]]))
            for name in Compensated.FIELDS:
                assert np.isfinite(getattr(result, name)).all(), name
