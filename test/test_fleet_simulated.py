"""The fleet that docs/FLEET.md shows: simulated, calibrated, its damaged recordings told."""

import json
from pathlib import Path

from benchmarks import fleet
from hgma_compensation.cli.main import main

ROOT = Path(__file__).parents[1]


def test_the_trial_of_the_document_runs(tmp_path):
    sensors, output = tmp_path / "sensors", tmp_path / "calibrated"
    assert fleet.main(["--simulate-only", str(sensors), "--sensors", "3"]) == 0
    limits = ROOT / "params" / "acceptance.yaml"
    arguments = ["-o", str(output), "--limits", str(limits), "--generations", "20"]
    assert main(["fleet", str(sensors), *arguments]) == 1
    summary = json.loads((output / "summary.json").read_text())
    assert {name: one["state"] for name, one in summary["sensors"].items()} == {
        "sensor_0000": "accepted",
        "sensor_0001": "failed",
        "sensor_0002": "failed",
    }
    assert "no thermistor" in summary["sensors"]["sensor_0001"]["reason"]
    assert "damaged" in summary["sensors"]["sensor_0002"]["reason"]


def test_the_benchmark_fails_where_anything_is_lost_or_differs():
    kill = fleet.Kill(1, ("b", "c"))
    counts = {"accepted": 2, "rejected": 0}
    good = fleet.Outcome(3, ("c",), kill, 1.0, 1.0, (), 9, (), counts, 0.5, ("c",), ("a",))
    changed = {"lost": ("a",), "differing": ("a/status.json",), "failed": ("b", "c")}
    assert good.good
    assert not any(fleet.Outcome(**{**vars(good), name: value}).good for name, value in changed.items())
    assert "| worker killed (SIGKILL) | after 1 sensors, in the middle of b and c |" in fleet.report(good)
