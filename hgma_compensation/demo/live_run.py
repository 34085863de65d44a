"""Plays a recording to the real node over DDS and records what the node publishes."""

import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
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
    # A state with every sample, so that what is recorded can be compared sample by sample.
    node = [*NODE, "--ros-args", "-p", f"calibration_file:={calibration}", "-p", "state_rate:=0.0"]
    play = [*HGMA, "play", str(recording), "--rate", str(rate), "--wait", "20"]
    with running(node, environment, READY):
        playing = _Playing(play, environment, samples)
        try:
            domain = int(environment["ROS_DOMAIN_ID"])
            return record(output, OUTPUTS, domain, connected=playing.start, until=playing.complete)
        finally:
            playing.stop()


class _Playing:
    """The player's process, and whether all that it sends has come back."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str], samples: int) -> None:
        self._command, self._environment, self._samples = command, environment, samples
        self._player: subprocess.Popen[bytes] | None = None
        self._count = 0
        self._changed = time.monotonic()

    def start(self) -> None:
        self._player = subprocess.Popen(self._command, env=dict(self._environment))

    def stop(self) -> None:
        if self._player is not None:
            self._player.terminate()
            self._player.wait()

    def complete(self, counts: Mapping[str, int]) -> bool:
        """Return whether every sample has come, or nothing comes any more."""
        assert self._player is not None
        count = min((counts.get(topic, 0) for topic in OUTPUTS), default=0)
        if count != self._count or self._player.poll() is None:
            self._count, self._changed = count, time.monotonic()
        return count >= self._samples or time.monotonic() - self._changed > PATIENCE
