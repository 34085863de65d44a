"""The soaks of the stream, for seconds instead of an hour."""

import json
import subprocess
import sys

import pytest

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def figures_of(*arguments):
    """Run a soak that must hold its bounds, and return its figures."""
    done = subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout.strip().splitlines()[-1])


def test_every_sample_of_a_stream_with_faults_is_accounted_for():
    figures = figures_of("benchmarks.soak.faults", "--seconds", "240", "--rate", "20", "--speed", "300")
    assert figures["samples_sent"] == figures["samples_compensated"] + figures["samples_skipped"]
    assert figures["samples_skipped"] > 0
    assert figures["kinds_of_faults"] > 15


def test_a_looping_bag_gives_the_same_bytes_each_time():
    figures = figures_of("benchmarks.soak.loops", "--rounds", "2", "--speed", "6")
    assert figures["outputs"] == figures["states"] == 2 * figures["samples_each"]
