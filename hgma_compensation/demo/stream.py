"""``make live``: a node that compensates a recording played in a loop, shown in the terminal until Ctrl-C."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from hgma_compensation.demo.live_run import NODE, READY
from hgma_compensation.demo.processes import HGMA, private_ros_environment, run_hgma, running
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.bag_reader import read_recording

BAG = Path("bags/oven_test")
CALIBRATION = Path("demo_output/live.json")
LOOP = 120.0
"""s in which the oven test of hours goes by."""


def main() -> int:
    """Train where that was not done yet, then stream; 0 after Ctrl-C."""
    os.chdir(Path(__file__).parents[2])
    with suppress(KeyboardInterrupt):
        try:
            return _stream(sys.argv[1:])
        except RefusedError as refusal:
            print(f"error: {refusal}", file=sys.stderr)
            return 2
    return 0


def _stream(watch_arguments: list[str]) -> int:
    if not CALIBRATION.exists():
        CALIBRATION.parent.mkdir(exist_ok=True)
        run_hgma("train", BAG, "-o", CALIBRATION, "--reference", "9.80665")
    environment = private_ros_environment()
    rate = read_recording(BAG).duration / LOOP
    node = [*NODE, "--ros-args", "-p", f"calibration_file:={CALIBRATION}"]
    domain = environment["ROS_DOMAIN_ID"]
    print(f"an oven test in {LOOP:.0f} s, again and again, {rate:.0f} times faster than recorded; Ctrl-C ends it")
    print(f"elsewhere: ROS_DOMAIN_ID={domain} .venv/bin/hgma watch, ros2 topic echo /accel/compensated, rqt_plot")
    with running(node, environment, READY):
        play = [*HGMA, "play", str(BAG), "--loop", "--rate", str(rate)]
        player = subprocess.Popen(play, env=environment, stderr=subprocess.DEVNULL)
        try:
            return subprocess.run([*HGMA, "watch", *watch_arguments], env=environment, check=False).returncode
        finally:
            player.send_signal(signal.SIGINT)
            player.wait()


if __name__ == "__main__":
    sys.exit(main())
