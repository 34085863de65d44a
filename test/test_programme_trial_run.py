import json

import pytest
import yaml
from test_cli import refused
from test_cli import run as hgma

from hgma_compensation.programme.plan import plan
from hgma_compensation.programme.programme import Wishes
from hgma_compensation.programme.trial_run import EXAMPLES, scenario_document, scenario_text
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.simulation.scenario import read_scenario


def scenario_of(tmp_path, text):
    path = tmp_path / "scenario.yaml"
    path.write_text(text, encoding="utf-8")
    return read_scenario(path)


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_every_effect_can_be_tried_on_a_simulated_sensor(name, tmp_path):
    made = plan(Wishes(effects=(name,), time_constant=900.0))
    scenario = scenario_of(tmp_path, scenario_text(made, (name,), seed=3))
    assert scenario.oven.duration == pytest.approx(60.0 * made.duration)
    assert [(effect.name, effect.declared) for effect in scenario.effects] == [(name, True)]


def test_all_effects_together_make_a_scenario(tmp_path):
    made = plan(Wishes(effects=tuple(EXAMPLES)))
    scenario = scenario_of(tmp_path, scenario_text(made, (), seed=3))
    assert scenario.effects == ()
    assert scenario.second_thermometer is not None
    assert scenario.supply is not None
    assert len(scenario.powered) == len(made.steps)
    assert scenario.motion.shocks
    assert scenario.motion.vibrations
    assert scenario.motion.orientations


def test_the_voltage_comes_back_to_where_it_is_said_to_be():
    made = plan(Wishes(effects=("supply_voltage",)))
    steps = scenario_document(made, (), 1)["supply_voltage"]["steps"]
    volts = 0.0
    for step, planned in zip(steps, made.happenings, strict=True):
        volts += step["change"]
        assert volts == pytest.approx(0.1 * planned.size, abs=1e-4)


def test_a_level_is_left_as_it_was_found():
    made = plan(Wishes(effects=("quadratic_nonlinearity",)))
    held = scenario_document(made, (), 1)["motion"]["orientations"]
    assert held[0]["specific_force_g"] == held[-1]["specific_force_g"] == [0.0, 0.0, 1.0]
    assert sum(entry["specific_force_g"][2] - 1.0 for entry in held) == pytest.approx(0.0, abs=1e-6)


def test_the_command_writes_what_simulate_takes(tmp_path):
    path, bag = tmp_path / "trial.yaml", tmp_path / "bag"
    quick = ("--from", "15", "--to", "35", "--ramp-rate", "20", "--mission-rate", "16")
    assert hgma("plan", "--effects", "threshold_step", *quick, "--scenario", path, "--json", tmp_path / "p.json") == 0
    assert yaml.safe_load(path.read_text())["effects"][0]["effect"] == "threshold_step"
    assert hgma("simulate", path, "-o", bag) == 0
    minutes = json.loads((tmp_path / "p.json").read_text())["duration_min"]
    assert read_recording(bag).duration == pytest.approx(60.0 * minutes, abs=1.0)


def test_an_effect_that_the_programme_is_not_for_is_refused(tmp_path, capsys):
    words = ("plan", "--effects", "aging", "--simulated", "warm_up", "--scenario", tmp_path / "s.yaml")
    assert "warm_up" in refused(capsys, *words)
    assert not (tmp_path / "s.yaml").exists()


def test_a_scenario_is_not_written_over(tmp_path, capsys):
    path = tmp_path / "mine.yaml"
    path.write_text("mine", encoding="utf-8")
    assert "exists" in refused(capsys, "plan", "--scenario", path)
    assert path.read_text(encoding="utf-8") == "mine"
