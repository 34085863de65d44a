"""Runs the shell blocks of a document as a reader would, in a folder of its own.

All of a document's ```sh blocks are one script, in their order. What stays in the foreground until it is interrupted (a
node, a player in a loop, a live view) goes on in the background until the block's end, and must then end cleanly.
Programs of a ROS installation are not on PyPI: ``ros2 run`` starts the same entry point and ``ros2 param set`` calls
the same service; what is named in NOT_RUN is only read. So are the targets of make (test_demo.py runs demo and live)
and the benchmarks.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

from hgma_compensation.demo.processes import private_ros_environment

ROOT = Path(__file__).parents[1]

NOT_RUN = {
    "colcon build": "colcon is no dependency of the tests, and needs a ROS installation's ament",
    "git clone": "the network",
    "ros2 bag": "rosbag2 is not on PyPI; hgma play and the tests of bags stand for it",
    "ros2 launch": "launch is not on PyPI; test_ros_files.py reads the launch file",
    "ros2 lifecycle": "ros2cli is not on PyPI; test_system_lifecycle.py does the transitions",
    "ros2 run": "of other packages: not on PyPI",
    "ros2 security": "sros2 is not on PyPI; test_system_security.py reads the policy",
    "ros2 service": "ros2cli is not on PyPI; test_system_node.py calls the services",
    "ros2 topic": "ros2cli is not on PyPI",
    "rqt_plot": "a desktop program; test_ros_files.py resolves its fields",
    "rviz2": "a desktop program",
}
"""Beginnings of commands that no machine without ROS can run, and what stands for them."""

STAYS = re.compile(r"(hgma node|compensation_node|hgma play .*--loop|hgma watch(?!.*--seconds))\b")
READY = {"hgma play": "", "hgma watch": "raw"}
"""What a program that stays says once it runs; a node names its calibration, or that it has none."""

ENDS_WITH = {"hgma fleet sensors -o calibrated": 1}
"""Commands of which the document says that they do not end with 0, and what they end with."""

TOLERANCE = 0.05
"""Of the numbers that a document shows: what is trained differs in its last digits between machines."""

PREAMBLE = """\
set -euo pipefail
started=()
stay() {  # ready, command
  local ready="$1" log; shift; log="$(mktemp)"
  "$@" >"$log" 2>&1 & started+=("$!")
  for _ in $(seq 600); do
    { [ -z "$ready" ] || grep -qE "$ready" "$log"; } && return
    kill -0 "$!" 2>/dev/null || break
    sleep 0.1
  done
  echo "$* did not start:"; cat "$log"; return 1
}
finish() {
  local failed=0
  for pid in "${started[@]}"; do kill -INT "$pid" 2>/dev/null || true; done
  for pid in "${started[@]}"; do wait "$pid" || { echo "a program that stayed ended with $?"; failed=1; }; done
  started=()
  return "$failed"
}
"""


def blocks(document: Path) -> list[list[str]]:
    """Return the commands of each shell block of a document, each on one line without its comment."""
    text = document.read_text(encoding="utf-8")
    found = re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [_commands(re.sub(r"\\\n\s*", "", block)) for block in found]


def _commands(block: str) -> list[str]:
    stripped = (re.sub(r"(^|\s+)#.*$", "", line).strip() for line in block.splitlines())
    return [line for line in stripped if line]


def run_document(document: Path, folder: Path, seconds: float) -> str:
    """Run a document's commands in a folder that has params, bags and .venv, and return what they printed.

    Fails with all of it where one fails.
    """
    for name in ("params", "bags", ".venv", "docs"):
        if not (folder / name).exists():
            (folder / name).symlink_to(ROOT / name)
    script = PREAMBLE + "".join("\n".join([*map(translated, block), "finish\n"]) for block in blocks(document))
    environment = {
        **private_ros_environment(),
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "PYTHONUNBUFFERED": "1",
    }
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
    )
    assert done.returncode == 0, f"{document.name}:\n{done.stdout}\n{done.stderr}"
    return done.stdout


def outputs(document: Path) -> list[str]:
    """Return what a document says that its commands print: its ```text blocks."""
    return re.findall(r"^```text\n(.*?)^```", document.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def is_printed(shown: str, printed: str) -> bool:
    """Return whether the words of a text stand one after another in what was printed, numbers within TOLERANCE."""
    words, there = _words(shown), _words(printed)
    starts = range(len(there) - len(words) + 1)
    return any(all(_alike(a, b) for a, b in zip(words, there[start:], strict=False)) for start in starts)


def _words(text: str) -> list[str]:
    return re.findall(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?|[^\s\d─]+", text)


def _alike(shown: str, printed: str) -> bool:
    if shown[0].isdigit() and printed[0].isdigit():
        return abs(float(shown) - float(printed)) <= TOLERANCE * abs(float(shown))
    return shown == printed


def translated(line: str) -> str:
    """Return what is run for a command of a document."""
    parts = [_one(part.strip()) for part in re.split(r"\s*&&\s*", line)]
    return "\n".join(parts)


def _one(command: str) -> str:
    words = shlex.split(command.partition("|")[0])
    if command.startswith("make "):
        return f"make -C {shlex.quote(str(ROOT))} -n {shlex.join(words[1:])} >/dev/null"
    if command.startswith("source ") and ".venv" not in command:
        return ":"
    if command.startswith("ros2 run hgma_compensation compensation_node"):
        command = command.removeprefix("ros2 run hgma_compensation ")
    elif command.startswith("ros2 param set"):
        return shlex.join([sys.executable, str(ROOT / "test" / "set_parameter.py"), *words[3:]])
    elif words[:2] == ["python", "-m"] and words[2].startswith("benchmarks.") and "--simulate-only" not in words:
        return _only_read(words)
    for beginning in NOT_RUN:
        if command.startswith(beginning):
            return f"echo {shlex.quote(f'not run: {command}')}"
    for beginning, code in ENDS_WITH.items():
        if command.startswith(beginning):
            return f'code=0; {command} || code=$?; [ "$code" = {code} ]'
    if STAYS.match(command):
        ready = next((text for name, text in READY.items() if command.startswith(name)), "calibration")
        return f"stay {shlex.quote(ready)} {command}"
    return command


def _only_read(words: list[str]) -> str:
    """Return a check of a benchmark's name and options: to run it takes minutes to hours."""
    options = [word.partition("=")[0] for word in words[3:] if word.startswith("--")]
    checks = [f'grep -qe {shlex.quote(option)} <<<"$text"' for option in options]
    return "; ".join([f'text="$(python -m {words[2]} --help)"', *checks])
