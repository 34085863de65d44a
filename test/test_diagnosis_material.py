from dataclasses import replace

import numpy as np
import pytest
from builders import make_stamps
from diagnosis_blocks import CHANNEL, NOISE, lag_problem, lagging, late, oven, plain_problem, problem_of
from effect_calibrations import switched_off, with_all_inputs

from hgma_compensation.diagnosis.blocks import SETTLING, make_blocks
from hgma_compensation.diagnosis.problem import without_rows
from hgma_compensation.diagnosis.runs import make_run, power_ons
from hgma_compensation.effects.hysteresis import Hysteresis
from hgma_compensation.effects.supply_voltage import SupplyVoltage
from hgma_compensation.effects.thermal_gradient import ThermalGradient
from hgma_compensation.effects.thermal_lag import ThermalLag
from hgma_compensation.effects.vibration_rectification import VibrationRectification
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.recording import Series

CALM = lagging(1, 2.0, gain=0.0)
BLOCK = 5.0


def with_values(values, recording=CALM):
    changed = recording.values.copy()
    changed[:, 2] = values
    return replace(recording, values=changed)


def blocks_of(recording, block=BLOCK, **options):
    return make_blocks([make_run(recording, NOISE)], CHANNEL, block, **options)


def test_a_block_holds_the_mean_of_its_samples():
    blocks = blocks_of(CALM)
    for index in (0, 50, len(blocks) - 1):
        part = slice(blocks.first[index], blocks.last[index])
        assert part.stop - part.start == 20
        assert blocks.values[index] == pytest.approx(CALM.values[part, 2].mean(), abs=0.05)
        assert blocks.stamps[index] == pytest.approx(CALM.stamps[part].mean(), abs=2e8)
    typical = np.median(blocks.white)
    assert typical == pytest.approx(0.3**2 / 20, rel=0.2)


@pytest.mark.parametrize("shock", [50.0, -5e4, np.nan, np.inf])
def test_a_sample_that_is_no_part_of_the_level_is_left_out(shock):
    before = blocks_of(CALM)
    values = CALM.values[:, 2].copy()
    index = 100
    values[before.first[index] + 7] = shock
    after = blocks_of(with_values(values))
    assert after.values[index] == pytest.approx(before.values[index], abs=0.2)
    assert after.white[index] < 4.0 * before.white[index]
    np.testing.assert_array_equal(np.delete(after.values, index), np.delete(before.values, index))


def test_a_block_without_samples_enough_is_no_block():
    blocks = blocks_of(CALM)
    gap = slice(blocks.first[50] + 2, blocks.last[50])
    kept = np.ones(len(CALM.stamps), dtype=bool)
    kept[gap] = False
    after = blocks_of(replace(CALM, stamps=CALM.stamps[kept], values=CALM.values[kept]))
    assert len(after) == len(blocks) - 1
    np.testing.assert_array_equal(after.values, np.delete(blocks.values, 50))


def test_what_settles_after_a_power_on_is_left_out():
    recording = switched_off(CALM)
    run = make_run(recording, NOISE)
    starts = run.smoothed.stamps[power_ons(run.smoothed.stamps)]
    assert len(starts) == 2
    for settling in (SETTLING, 60.0):
        blocks = make_blocks([run], CHANNEL, BLOCK, settling)
        firsts = recording.stamps[blocks.first]
        before, after = firsts[firsts < starts[1]], firsts[firsts >= starts[1]]
        assert SETTLING <= (before[0] - starts[0]) * 1e-9 <= SETTLING + BLOCK
        assert settling <= (after[0] - starts[1]) * 1e-9 <= settling + BLOCK
        # The pause is not spanned.
        assert np.all((recording.stamps[blocks.last - 1] - firsts) * 1e-9 <= BLOCK)


def test_the_past_ends_at_the_power_on():
    run = make_run(switched_off(CALM), NOISE)
    second = run.smoothed.stamps[power_ons(run.smoothed.stamps)[1]]
    assert set(run.power_on.tolist()) == {int(run.smoothed.stamps[0]), int(second)}
    np.testing.assert_array_equal(run.power_on == second, run.smoothed.stamps >= second)


def test_memories_follow_the_true_temperature():
    problem = lag_problem()
    lag = ThermalLag(45.0, -10.0, 60.0, 0.0)
    column = problem.columns([lag])[0][:, 0]
    blocks = problem.scene.blocks
    for number, cycles in enumerate((2.0, 4.0)):
        rows = blocks.run == number
        seconds = np.arange(0.0, 1800.0, 0.25)
        temperature = oven(seconds, cycles)
        at = (blocks.stamps[rows] - problem.scene.runs[number].recording.start) * 1e-9
        truth = np.interp(at, seconds, late(seconds, temperature, 45.0) - temperature)
        assert np.sqrt(np.mean((column[rows] - truth) ** 2)) < 0.02 * truth.std()


def test_many_effects_at_once_have_the_columns_of_each():
    problem = without_rows(lag_problem(), np.ones(len(lag_problem().values), dtype=bool))
    lag = ThermalLag(45.0, -10.0, 60.0, 3.0, 2.0, 2.0)
    effects = [Hysteresis(4.0, 2.0, plays=3.0), lag, VibrationRectification(5.0, 0.1, CHANNEL), Hysteresis(1.0)]
    together = problem.scene.columns(effects)
    for effect, columns in zip(effects, together, strict=True):
        assert columns.shape == (len(problem.values), effect.count)
        np.testing.assert_array_equal(columns, problem.scene.columns([effect])[0])


def test_memories_are_carried_from_run_to_run_where_they_are_said_to():
    scene = plain_problem().scene
    play = Hysteresis(10.0)
    apart = scene.columns([play])[0][:, 0]
    carried = replace(scene, carried=True)
    together = carried.columns([play])[0][:, 0]
    first = scene.blocks.run == 0
    np.testing.assert_array_equal(apart[first], together[first])
    start = np.flatnonzero(~first)[0]
    # The first day ends with a soak in the cold, after which the play stands above it; a new one stands at it.
    assert together[start] > apart[start] + 5.0
    states = carried.states_about(play)
    assert states[0][1] == pytest.approx(states[1][0], abs=1e-9)


def test_conditions_hold_what_else_was_recorded():
    recording = with_all_inputs(duration_s=400.0)
    voltage = Series(recording.supply_voltage.stamps, np.linspace(4.0, 6.0, len(recording.supply_voltage.stamps)))
    problem = problem_of([replace(recording, supply_voltage=voltage, temperature_2=voltage)], block=2.0)
    scene = problem.scene
    stamps = scene.blocks.stamps
    at = scene.conditions(0, stamps, np.zeros((len(stamps), 6)))
    known = stamps >= voltage.stamps[0]
    newest = np.searchsorted(voltage.stamps, stamps[known], side="right") - 1
    np.testing.assert_array_equal(at.supply_voltage[known], voltage.values[newest])
    assert np.isnan(at.supply_voltage[~known]).all()
    column = scene.columns([SupplyVoltage(5.0)])[0][:, 0]
    np.testing.assert_allclose(column[known], voltage.values[newest] - 5.0)
    assert not column[~known].any()
    inside = slice(20, -20)
    expected = np.interp(stamps, voltage.stamps, voltage.values)
    np.testing.assert_allclose(at.temperature_2[inside], expected[inside], atol=0.05)
    gradient = scene.columns([ThermalGradient()])[0][:, 0]
    np.testing.assert_allclose(gradient, at.temperature_2 - at.temperature)
    assert problem.survey.voltage == pytest.approx(5.0, abs=0.1)


def test_rows_can_be_left_out_of_a_problem_without_changing_the_others():
    problem = lag_problem()
    rows = problem.scene.blocks.run == 1
    rows[::3] = False
    part = without_rows(problem, rows)
    lag = ThermalLag(100.0, -10.0, 60.0, 0.0)
    np.testing.assert_array_equal(part.values, problem.values[rows])
    np.testing.assert_array_equal(part.baseline, problem.baseline[rows])
    np.testing.assert_array_equal(part.columns([lag])[0], problem.columns([lag])[0][rows])


@pytest.mark.parametrize("kept", [0, 1, 40])
def test_a_thermistor_that_says_nothing_is_refused(kept):
    temperature = CALM.temperature.values.copy()
    temperature[kept:] = np.nan
    with pytest.raises(RefusedError, match="day 1: fewer than 50 usable thermistor samples"):
        make_run(replace(CALM, temperature=Series(CALM.temperature.stamps, temperature)), NOISE)


def test_a_second_thermometer_that_says_nothing_is_none():
    silent = Series(CALM.temperature.stamps, np.full(len(CALM.temperature.stamps), np.nan))
    assert make_run(replace(CALM, temperature_2=silent), NOISE).second is None
    assert make_run(replace(CALM, temperature_2=CALM.temperature), NOISE).second is not None


def test_blocks_stand_in_the_order_of_their_runs():
    runs = [make_run(one, NOISE) for one in (CALM, lagging(2, 4.0, gain=0.0))]
    blocks = make_blocks(runs, CHANNEL, BLOCK)
    assert blocks.run.tolist() == sorted(blocks.run.tolist())
    apart = blocks.stamps[blocks.run == 1].min() - blocks.stamps[blocks.run == 0].max()
    assert apart > make_stamps(np.array([80000.0]), 0)[0]
