"""A second thermometer that follows the first one says nothing of a gradient; one that is heated by itself does."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import EPOCH, make_stamps
from diagnosis_blocks import DAY, LASTS, NOISE, THERMISTOR, lagging, late, oven, problem_of
from test_coverage_check import checked

from hgma_compensation.coverage.result import Level
from hgma_compensation.diagnosis.forward import FOLLOWS, Forward
from hgma_compensation.diagnosis.leftover import slow_directions
from hgma_compensation.diagnosis.own_motion import needs_own_motion, noisier, own_motion
from hgma_compensation.diagnosis.problem import State
from hgma_compensation.diagnosis.runs import read_smoothed
from hgma_compensation.effects.registry import kinds
from hgma_compensation.effects.thermal_gradient import ThermalGradient
from hgma_compensation.effects.thermal_lag import ThermalLag
from hgma_compensation.recording.recording import Series

GRADIENT = ThermalGradient.name
BEHIND = 30.0
"""s by which the first thermometer is behind what the second one sees."""

CYCLES = (4.0, 8.0)


def day(number, cycles, *, rise=0.0, gain=0.0, rate_gain=0.0):
    """Return a day without a lag. rise: °C of one-sided heat. rate_gain: of the drift with the rate, per °C/s."""
    recording = lagging(number, cycles, gain=0.0)
    random = np.random.default_rng(number)

    def temperatures(seconds):
        around = oven(seconds, cycles)
        pulses = rise * ((seconds % 200.0) > 140.0) * np.where((seconds % 400.0) < 200.0, 1.0, -0.7)
        return late(seconds, around, BEHIND), around + late(seconds, pulses, 5.0)

    seconds, slow = (recording.stamps - recording.stamps[0]) * 1e-9, np.arange(int(LASTS))
    first, second = temperatures(seconds)
    values = recording.values.copy()
    values[:, 2] = 9.81 + 0.4 * first + 0.3 * random.standard_normal(len(seconds))
    values[:, 2] += gain * (second - first) + rate_gain * np.gradient(first, seconds)
    measured = [one + THERMISTOR * random.standard_normal(len(slow)) for one in temperatures(slow)]
    stamps = make_stamps(number * DAY + slow)
    return replace(
        recording, values=values, temperature=Series(stamps, measured[0]), temperature_2=Series(stamps, measured[1])
    )


@cache
def days(**sizes):
    return tuple(day(number, cycles, **sizes) for number, cycles in enumerate(CYCLES))


def searched(**sizes):
    return Forward(problem_of(list(days(**sizes))), np.random.default_rng(1)).run()


def motion_of(**sizes):
    state = State.of(problem_of(list(days(**sizes))), [])
    (scored,) = state.score([ThermalGradient()])
    return own_motion(state, scored, slow_directions(state), np.random.default_rng(2))


def reasons(findings):
    return {one.scored.name: one.reason for stage in findings.stages for one in stage}


def test_it_is_asked_of_a_measured_input_that_may_look_like_the_temperature():
    asked = {name for name, kind in kinds().items() if needs_own_motion(kind)}
    assert asked == {GRADIENT}


def test_a_second_thermometer_that_is_only_ahead_has_nothing_of_its_own():
    motion = motion_of()
    assert not motion.moves


@pytest.mark.parametrize("rise", [2.0, 6.0])
def test_one_that_is_heated_from_its_side_has(rise):
    motion = motion_of(rise=rise)
    assert motion.moves
    assert motion.share > 0.95


def test_the_more_heat_the_more_of_it_is_motion():
    shares = [motion_of(rise=rise).share for rise in (0.0, 0.2, 2.0)]
    assert shares == sorted(shares)


def test_a_rate_that_the_second_thermometer_shows_better_is_no_gradient():
    # The derivative of one thermometer carries its noise into the residual, and T2 - T knows that noise.
    state = State.of(problem_of(list(days(rate_gain=120.0))), [])
    assert state.score([ThermalGradient()])[0].bic < -15.0
    motion = motion_of(rate_gain=120.0)
    assert not motion.moves
    assert motion.gain < motion.scored.gain or not motion.scored.gain


def test_a_gradient_with_heat_from_one_side_is_named():
    findings = searched(rise=4.0, gain=0.5)
    assert [one.effect.name for one in findings.found] == [GRADIENT]
    assert findings.undecided == ()


def test_a_rate_beside_heat_that_the_sensor_does_not_follow_is_no_gradient():
    findings = searched(rise=4.0, rate_gain=120.0)
    assert GRADIENT not in [one.effect.name for one in findings.found]
    assert reasons(findings)[GRADIENT] != FOLLOWS
    assert findings.undecided == ()


def test_twice_the_noise_is_added_and_nothing_else_changes():
    problem = problem_of(list(days()))
    other = noisier(problem, np.random.default_rng(3))
    before, after = (one.scene.runs[0] for one in (problem, other))
    stamps = EPOCH + (np.arange(100, 1700) * 1e9).astype(np.int64)
    for own, again in ((before.smoothed, after.smoothed), (before.second, after.second)):
        added = read_smoothed(again, stamps)[0] - read_smoothed(own, stamps)[0]
        smoothing = np.sqrt(NOISE.measurement) * 0.2, np.sqrt(NOISE.measurement)
        assert smoothing[0] < added.std() < smoothing[1]
    np.testing.assert_array_equal(other.values, problem.values)
    np.testing.assert_array_equal(other.scene.put_in, problem.scene.put_in)
    assert not np.array_equal(other.features, problem.features)
    lag = ThermalLag(20.0, -10.0, 60.0, 0.0)
    assert not np.array_equal(other.columns([lag])[0], problem.columns([lag])[0])


def test_a_check_says_the_same():
    follows, heated = (
        checked([*days(rise=rise), day(3, 6.0, rise=rise)], GRADIENT)[0][GRADIENT] for rise in (0.0, 4.0)
    )
    assert (follows.level, follows.reason, follows.size) == (Level.NOT, FOLLOWS, None)
    assert "heat from another side" in follows.remedy
    assert heated.level is not Level.NOT
    assert heated.size > 0.0
