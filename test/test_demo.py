"""``make demo`` and ``make live`` as they are run, without make."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]
ROOT = Path(__file__).parents[1]


def run(module, *arguments):
    return subprocess.run(
        [sys.executable, "-m", module, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=280, check=False
    )


def test_the_live_stream_is_compensated(tmp_path):
    done = run("hgma_compensation.demo.stream", "--seconds", "12", "--json", str(tmp_path / "seen.json"))
    assert done.returncode == 0, done.stdout + done.stderr
    seen = json.loads((tmp_path / "seen.json").read_text())
    channel = seen["channels"]["linear_acceleration.z"]
    assert seen["compensated_rate"] > 50.0
    assert seen["temperature_status"] == "OK"
    assert abs(channel["raw"] - 9.80665) > 1000.0  # m/s², as the oven is well away from 25 °C by then
    assert abs(channel["compensated"] - 9.80665) < 200.0
