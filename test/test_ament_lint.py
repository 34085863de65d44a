"""The style that ament_flake8 asks for, with the settings that setup.cfg gives to it: flake8 with the same file."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ("hgma_compensation", "hgma_msgs", "launch", "benchmarks", "test", "setup.py")


def flake8(*arguments):
    command = [sys.executable, "-m", "flake8", "--config", str(ROOT / "setup.cfg"), *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_flake8_finds_nothing_with_the_settings_given_to_ament():
    found = flake8(*SOURCES)
    assert (found.returncode, found.stdout, found.stderr) == (0, "", "")


def test_flake8_would_find_something(tmp_path):
    (tmp_path / "bad.py").write_text("import os\nx = undefined\n")
    assert {"F401", "F821"} <= set(flake8(str(tmp_path / "bad.py")).stdout.split())
