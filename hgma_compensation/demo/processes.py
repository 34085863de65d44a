"""Starts the project's own commands as a user's shell would."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from hgma_compensation.demo.ros_domain import take_domain

HGMA = (sys.executable, "-m", "hgma_compensation.cli.main")
STOP_TIMEOUT = 20.0


def private_ros_environment() -> dict[str, str]:
    """Return an environment in which ROS talks on this machine only, in a domain that is this process's own.

    A domain that ROS_DOMAIN_ID names is kept. Raises RuntimeError where all others are taken.
    """
    domain = os.environ.get("ROS_DOMAIN_ID") or str(take_domain())
    return {**os.environ, "ROS_DOMAIN_ID": domain, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


def run_hgma(*arguments: str | Path, environment: Mapping[str, str] | None = None) -> None:
    """Run an hgma command, shown on the terminal; raises CalledProcessError where it fails."""
    words = [str(argument) for argument in arguments]
    print("$ hgma", *words, flush=True)
    subprocess.run([*HGMA, *words], check=True, env=environment)


@contextmanager
def running(command: Sequence[str], environment: Mapping[str, str], ready: str) -> Iterator[subprocess.Popen[str]]:
    """Run a process from the moment it has printed ``ready`` until the block ends; then SIGINT.

    Raises RuntimeError with its output where it ends before that, and where it does not end cleanly.
    """
    process = subprocess.Popen(
        command, env=dict(environment), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    output = _Output(process, ready)
    try:
        if not output.wait():
            raise RuntimeError(f"{' '.join(command)} did not start:\n{output.text}")
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(STOP_TIMEOUT)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}:\n{output.text}")


class _Output:
    """Reads what a process prints, so that it never blocks on a full pipe."""

    def __init__(self, process: subprocess.Popen[str], ready: str) -> None:
        self._process, self._ready = process, ready
        self._lines: list[str] = []
        self._seen = threading.Event()
        threading.Thread(target=self._read, daemon=True).start()

    @property
    def text(self) -> str:
        return "".join(self._lines)

    def wait(self, timeout: float = 60.0) -> bool:
        self._seen.wait(timeout)
        return any(self._ready in line for line in self._lines)

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.append(line)
            if self._ready in line:
                self._seen.set()
        self._seen.set()
