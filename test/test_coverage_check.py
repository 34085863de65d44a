import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording, make_stamps
from diagnosis_blocks import CHANNEL, lag_problem, lagging, plain_problem, trained_before
from test_cli import refused
from test_cli import run as hgma

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.coverage.check import check
from hgma_compensation.coverage.judge import LARGE
from hgma_compensation.coverage.reading import reading_of
from hgma_compensation.coverage.result import Level
from hgma_compensation.coverage.sensitivity import Sensitivity
from hgma_compensation.coverage.trials import confirmed
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.effects.thermal_lag import ThermalLag
from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.recording import Series


@cache
def days(gain=0.0):
    return [lagging(day, cycles, gain=gain) for day, cycles in enumerate((2.0, 4.0, 3.0))]


def checked(recordings, *effects, **options):
    readings = [reading_of(recording) for recording in recordings]
    (channel,) = check(readings, effects=effects or None, channels=(CHANNEL,), **options).channels
    return {effect.name: effect for effect in channel.effects}, channel


@pytest.fixture(scope="module")
def plain():
    """Return what is said of three days without an effect."""
    return checked(days())


def test_what_the_oven_sets_off_is_identifiable_and_the_rest_is_not(plain):
    effects, _ = plain
    assert {effects[name].level for name in ("thermal_lag", "hysteresis", "threshold_step")} == {Level.IDENTIFIABLE}
    for name in ("supply_voltage", "thermal_gradient", "cross_axis", "post_shock_zero_shift"):
        assert effects[name].level is Level.NOT
        assert effects[name].size is None
        assert effects[name].remedy.startswith("record ")
    assert "accel/supply_voltage" in effects["supply_voltage"].reason
    assert "vibrates" in effects["vibration_rectification"].reason


def test_sizes_are_those_that_the_levels_speak_of(plain):
    effects, channel = plain
    for effect in effects.values():
        if effect.level is Level.IDENTIFIABLE:
            assert 0.0 < effect.size <= LARGE * channel.small
        if effect.parameter is not None:
            assert effect.parameter.low <= effect.parameter.value <= effect.parameter.high


def test_an_effect_of_twice_the_size_is_named(plain):
    effects, _ = plain
    size = effects["thermal_lag"].size
    quiet, lagged = days(), days(gain=1.5)
    own = np.std((lagged[0].values - quiet[0].values)[:, 2])
    scaled = [
        replace(q, values=q.values + (2.0 * size / own) * (full.values - q.values))
        for q, full in zip(quiet, lagged, strict=True)
    ]
    (channel,) = diagnose(scaled[:2], trained_before(), scaled[2]).channels
    assert [effect.name for effect in channel.effects] == ["thermal_lag"]


def test_half_the_noise_halves_the_size():
    louder, quieter = (
        Sensitivity.of(problem, np.random.default_rng(1)) for problem in (plain_problem(), quiet_problem())
    )
    sizes = [
        next(p.size for p in one.points if isinstance(p.effect, ThermalLag) and p.effect.time_constant > 40.0)
        for one in (louder, quieter)
    ]
    assert sizes[1] == pytest.approx(0.5 * sizes[0], rel=0.25)


def quiet_problem():
    from diagnosis_blocks import problem_of

    return problem_of([lagging(1, 2.0, gain=0.0, noise=0.15), lagging(2, 4.0, gain=0.0, noise=0.15)])


def test_an_effect_that_is_there_does_not_hide_the_others():
    sizes = []
    for problem in (plain_problem(), lag_problem()):
        points = Sensitivity.of(problem, np.random.default_rng(1)).points
        sizes.append(min(p.size for p in points if p.effect.name == "threshold_step"))
    assert sizes[1] == pytest.approx(sizes[0], rel=0.3)


def test_a_size_is_raised_until_left_out_cycles_confirm_it():
    sensitivity = Sensitivity.of(plain_problem(), np.random.default_rng(1))
    point = next(p for p in sensitivity.points if isinstance(p.effect, ThermalLag) and p.effect.time_constant > 40.0)
    found = confirmed(sensitivity.state, point, np.random.default_rng(2))
    assert found.size == pytest.approx(point.size, rel=2.5)
    tiny = replace(point, size=1e-4 * point.size, values=1e-4 * point.values)
    assert confirmed(sensitivity.state, tiny, np.random.default_rng(2)) is None


def test_one_sweep_names_nothing_by_itself():
    effects, channel = checked([lagging(1, 1.0)])
    assert channel.sweeps < 4
    assert effects["threshold_step"].level is Level.NOT
    assert "4 are needed" in effects["threshold_step"].reason
    assert effects["thermal_lag"].level is not Level.IDENTIFIABLE


def test_a_logged_voltage_that_stands_still_shows_nothing_and_one_that_steps_does():
    random = np.random.default_rng(5)
    recordings = {}
    for name, step in (("still", 0.0), ("stepping", 0.1)):
        made = []
        for day in days():
            seconds = np.arange(0.0, 1800.0, 2.0)
            volts = 5.0 + 1e-3 * random.standard_normal(900) + step * (np.floor(seconds / 130.0) % 3.0)
            made.append(
                replace(day, supply_voltage=Series(day.start + make_stamps(seconds) - make_stamps([0.0]), volts))
            )
        recordings[name] = made
    assert checked(recordings["still"], "supply_voltage")[0]["supply_voltage"].level is Level.NOT
    assert checked(recordings["stepping"], "supply_voltage")[0]["supply_voltage"].level is Level.IDENTIFIABLE


def test_at_one_temperature_nothing_of_temperature_shows():
    still = make_recording(duration_s=1200.0, accel_rate=5.0, low=25.0, high=25.0, channels=(CHANNEL,))
    effects, _ = checked([still])
    assert {one.level for one in effects.values()} == {Level.NOT}
    assert "°C only" in effects["thermal_lag"].reason


def test_the_same_seed_says_the_same():
    first, second = (checked(days()[:2], "thermal_lag", seed=4)[0] for _ in range(2))
    assert first == second


def test_lag_and_delay_are_said_to_look_alike(plain):
    _, channel = plain
    assert ("thermal_lag", "timing_offset") in {(pair.first, pair.second) for pair in channel.look_alikes}


def test_the_command_prints_and_writes_what_it_found(tmp_path, capsys):
    for number, day in enumerate(days()):
        write_recording(replace(day, name=f"day{number}"), tmp_path / f"day{number}")
    bags = [tmp_path / f"day{number}" for number in range(3)]
    assert hgma("check", *bags, "--effects", "thermal_lag,supply_voltage", "--json", tmp_path / "c.json") == 0
    printed = capsys.readouterr().out
    assert "thermal_lag" in printed
    assert "no supply voltage" in printed
    figures = json.loads((tmp_path / "c.json").read_text())
    assert figures["holdout"] == "day2"
    assert [one["name"] for one in figures["recordings"]] == ["day0", "day1", "day2"]
    effects = figures["channels"][CHANNEL]["effects"]
    assert {name: one["level"] for name, one in effects.items()} == {
        "thermal_lag": "identifiable",
        "supply_voltage": "not",
    }
    assert effects["thermal_lag"]["parameter"]["name"] == "time_constant"


@pytest.fixture
def bag(tmp_path):
    write_recording(make_recording(duration_s=100.0, channels=LINEAR[:1]), tmp_path / "bag")
    return tmp_path / "bag"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--effects", "moonlight"], "moonlight"),
        (["--channels", "linear_acceleration.z"], "linear_acceleration.z"),
        (["--until", "10"], "record for longer"),
        (["--from", "1e6"], "no sample from"),
        (["--calibration", "nowhere.json"], "nowhere.json"),
        (["--json", "nowhere/check.json"], "nowhere"),
        (["--remap", "/accel/temperature:=/elsewhere"], "no thermistor"),
    ],
)
def test_mistakes_are_refused(words, said, bag, capsys):
    assert said in refused(capsys, "check", bag, *words)


def test_a_calibration_that_does_not_fit_is_refused(bag, tmp_path, capsys):
    write_calibration(make_calibration(channels=LINEAR[:1]), tmp_path / "cal.json")
    words = ("check", bag, "--calibration", tmp_path / "cal.json", "--channels", LINEAR[2])
    assert LINEAR[2] in refused(capsys, *words)
    hot = make_recording(duration_s=300.0, channels=LINEAR[:1], low=150.0, high=180.0)
    write_recording(hot, tmp_path / "hot")
    assert "°C" in refused(capsys, "check", tmp_path / "hot", "--calibration", tmp_path / "cal.json")


def test_no_bag_and_the_same_bag_twice_are_refused(bag, capsys):
    assert "does not exist" in refused(capsys, "check", bag.parent / "none")
    assert "given twice" in refused(capsys, "check", bag, bag)
    assert "given twice" in refused(capsys, "check", bag, "--holdout", bag)
