from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_calibration
from diagnosis_blocks import (
    CHANNEL,
    calibration_of_z,
    diagnosis_of_days,
    lag_problem,
    lagging,
    lagging_days,
    plain_problem,
)

from hgma_compensation.calibration.document import read_calibration, with_id, write_calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.diagnosis.augment import augmented
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.diagnosis.problem import State
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.effects.hysteresis import Hysteresis
from hgma_compensation.effects.registry import kinds
from hgma_compensation.effects.thermal_lag import ThermalLag
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.recording.compensated_bag import compensate_recording

LAG = ThermalLag(45.0, -10.0, 60.0, 0.0)
COLUMN = CHANNELS.index(CHANNEL)


@pytest.fixture(scope="module")
def state():
    return State.of(lag_problem(), [LAG])


@pytest.fixture(scope="module")
def result(state):
    calibration, levels = augmented(calibration_of_z(), CHANNEL, state)
    assert levels.shape == (0,)
    return with_id(calibration)


def block_means(state, calibration):
    """Return the means (n,) of what the pipeline makes of the recordings, over the blocks of the problem."""
    scene = state.problem.scene
    means = np.empty(len(scene.blocks))
    for number, run in enumerate(scene.runs):
        values = compensate_recording(run.recording, calibration).values[:, 0]
        for row in np.flatnonzero(scene.blocks.run == number):
            means[row] = values[scene.blocks.first[row] : scene.blocks.last[row]].mean()
    return means


def test_the_calibration_survives_its_file(result, tmp_path):
    write_calibration(result, tmp_path / "augmented.json")
    read = read_calibration(tmp_path / "augmented.json")
    assert read.calibration_id == result.calibration_id
    assert [applied.effect for applied in read.effects] == [LAG]
    np.testing.assert_array_equal(read.effects[0].gains, result.effects[0].gains)
    recording = lagging(3, 3.0)
    before, after = (compensate_recording(recording, one).values for one in (result, read))
    np.testing.assert_array_equal(before, after)


def test_what_was_fitted_is_what_the_pipeline_does(state, result):
    left = block_means(state, result) - result.channels[0].reference
    assert np.sqrt(np.mean(left**2)) == pytest.approx(result.channels[0].error.fit, rel=0.02)
    # Nothing is left along the columns of the fit but what a ridge leaves.
    scaled = state.problem.columns([LAG])[0][:, 0]
    assert abs(np.corrcoef(left, scaled)[0, 1]) < 0.02


def test_it_removes_drift_and_lag_of_a_recording_that_it_has_not_seen(state, result):
    assert result.effects[0].gains == pytest.approx([0.6], rel=0.05)
    plain = with_id(augmented(calibration_of_z(), CHANNEL, State.of(state.problem, []))[0])
    recording = lagging(3, 3.0)
    settled = slice(200, None)
    errors = {
        name: float(np.std(compensate_recording(recording, one).values[settled, 0].reshape(-1, 20).mean(axis=1)))
        for name, one in (("plain", plain), ("lag", result))
    }
    assert plain.effects == ()
    assert errors["lag"] < 0.5 * errors["plain"]
    assert errors["lag"] < 2.0 * 0.3 / np.sqrt(20.0)


def test_only_the_channel_in_question_is_touched(state):
    other = AppliedEffect(LINEAR[0], Hysteresis(3.0), np.array([0.5]))
    replaced = AppliedEffect(CHANNEL, Hysteresis(5.0), np.array([9.0]))
    before = make_calibration(channels=LINEAR, effects=[other, replaced])
    before = replace(before, features=calibration_of_z().features)
    after, _ = augmented(before, CHANNEL, state)
    assert after.channels[:2] == before.channels[:2]
    assert after.channels[2].reference == before.channels[2].reference
    assert [(e.channel, e.effect) for e in after.effects] == [(LINEAR[0], other.effect), (CHANNEL, LAG)]


def test_plays_begin_where_the_last_recording_left_them():
    problem = plain_problem()
    carried = replace(problem, scene=replace(problem.scene, carried=True), cache={})
    play = Hysteresis(8.0)
    begun = augmented(calibration_of_z(), CHANNEL, State.of(carried, [play]))[0].effects[0].effect
    fresh = augmented(calibration_of_z(), CHANNEL, State.of(problem, [play]))[0].effects[0].effect
    assert fresh == play
    last = problem.scene.runs[-1].smoothed.temperature[-1]
    assert begun == replace(play, before=float(last), offset=begun.offset)
    # The last day ends in the cold, coming from above.
    assert begun.offset == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("mode", [FilterMode.SMOOTH, FilterMode.BIAS])
def test_a_filter_lets_the_level_wander_less_once_more_is_explained(state, mode):
    base = calibration_of_z()
    noise = RandomWalkNoise.with_time_constant(white=0.02, seconds=0.5)
    settings = FilterSettings(mode, noise, initial_bias=0.1 if mode is FilterMode.BIAS else 0.0, wander=0.05)
    filtered = replace(base, channels=tuple(replace(c, filter=settings) for c in base.channels))
    after = augmented(filtered, CHANNEL, state)[0].channels[0].filter
    assert 0.0 <= after.wander < settings.wander
    assert replace(after, wander=settings.wander) == settings


# A calibration that was augmented already --------------------------------------------------------------------------


@pytest.mark.parametrize("withheld", [frozenset(), frozenset(kinds())])
def test_diagnosed_again_a_calibration_keeps_the_effects_that_it_has(withheld):
    first = diagnosis_of_days()
    assert [applied.effect.name for applied in first.calibration.effects] == ["thermal_lag"]
    days = lagging_days()
    second = diagnose(days[:2], first.calibration, days[2], withheld=withheld)
    again = second.channels[0]
    assert again.error_before == pytest.approx(first.channels[0].error_after, rel=0.05)
    # What it says of the calibration that it writes is true.
    after = diagnose(days[:2], second.calibration, days[2], withheld=frozenset(kinds())).channels[0].error_before
    assert after == pytest.approx(again.error_after, rel=0.05)
    assert after <= again.error_before * 1.05
