"""Plays a recording to the real node over DDS and records what the node publishes."""

import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

from hgma_compensation import topics
from hgma_compensation.demo.processes import HGMA, private_ros_environment, running
from hgma_compensation.recording import typestore as types

NODE = (sys.executable, "-m", "hgma_compensation.node.main")
READY = "using calibration"
PATIENCE = 10.0
"""s without a new message after the player has ended, before the recording is taken as complete."""

OUTPUTS = {
    topics.in_bag(topics.COMPENSATED): types.IMU,
    topics.in_bag(topics.STATE): types.STATE,
}


def run_live(recording: Path, calibration: Path, output: Path, *, rate: float, samples: int) -> Mapping[str, int]:
    """Run node, player and recorder; return how many messages of each output topic came.

    recording, output: bags. rate: times faster than recorded. samples: accelerations in the recording.
    """
    from hgma_compensation.demo.recorder import record

    environment = private_ros_environment()
    node = [*NODE, "--ros-args", "-p", f"calibration_file:={calibration}"]
    play = [*HGMA, "play", str(recording), "--rate", str(rate), "--wait", "20"]
    with running(node, environment, READY):
        player = subprocess.Popen(play, env=environment)
        try:
            complete = _Complete(player, samples)
            return record(output, OUTPUTS, int(environment["ROS_DOMAIN_ID"]), complete)
        finally:
            player.terminate()
            player.wait()


class _Complete:
    """True when every sample has come, or when nothing comes any more."""

    def __init__(self, player: subprocess.Popen[bytes], samples: int) -> None:
        self._player, self._samples = player, samples
        self._count = 0
        self._changed = time.monotonic()

    def __call__(self, counts: Mapping[str, int]) -> bool:
        count = min((counts.get(topic, 0) for topic in OUTPUTS), default=0)
        if count != self._count or self._player.poll() is None:
            self._count, self._changed = count, time.monotonic()
        return count >= self._samples or time.monotonic() - self._changed > PATIENCE
