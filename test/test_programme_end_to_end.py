"""From a plan over the simulated sensor to the name of the effect that the plan was for."""

import json

import pytest
from test_cli import run as hgma


@pytest.mark.slow
@pytest.mark.parametrize("name", ["thermal_lag", "supply_voltage"])
def test_what_is_planned_for_is_identifiable_and_named(name, tmp_path):
    trial, bag, plan, said = (tmp_path / part for part in ("trial.yaml", "bag", "plan.json", "check.json"))
    quick = ("--from", 0, "--to", 50, "--ramp-rate", 8, "--mission-rate", 6)
    assert hgma("plan", "--effects", name, *quick, "--scenario", trial, "--json", plan) == 0
    assert hgma("simulate", trial, "-o", bag) == 0
    assert name in (bag / "metadata.yaml").read_text(encoding="utf-8")
    assert hgma("check", bag, "--effects", name, "--json", said) == 0
    checked = json.loads(said.read_text())["channels"]["linear_acceleration.z"]["effects"][name]
    assert checked["level"] == "identifiable"
    until = json.loads(plan.read_text())["hold_out_from_s"]
    assert hgma("train", bag, "--until", until, "--method", "polynomial-rate", "-o", tmp_path / "cal.json") == 0
    assert hgma("diagnose", bag, "--calibration", tmp_path / "cal.json", "-o", tmp_path / "found") == 0
    found = json.loads((tmp_path / "found" / "diagnosis.json").read_text())["channels"]["linear_acceleration.z"]
    assert [effect["name"] for effect in found["effects"]] == [name]
    assert found["error_after"] < 0.5 * found["error_before"]
