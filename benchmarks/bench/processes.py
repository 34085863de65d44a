"""Processes that are measured: the node, the plain relay, and what the kernel says of them."""

import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from benchmarks.soak.resident import children_of

END = 20.0
"""s that a process has to end after SIGINT."""


def node_command(calibration: Path, *parameters: str) -> list[str]:
    """Return the command of the node with a calibration and further ``name:=value`` parameters."""
    given = (f"calibration_file:={calibration}", *parameters)
    words = [word for parameter in given for word in ("-p", parameter)]
    return [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words]


def relay_command(kind: str, depth: int, *options: str) -> list[str]:
    """Return the command of the plain relay of "imu" or "block" messages."""
    return [sys.executable, "-m", "benchmarks.bench.relay", kind, str(depth), *options]


@contextmanager
def started(command: Sequence[str]) -> Iterator[subprocess.Popen[bytes]]:
    """Run a process until the block ends, then SIGINT.

    Raises RuntimeError with what it said where it does not end cleanly; also where it had ended before.
    """
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(END)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if process.returncode:
            output.seek(0)
            said = output.read().decode(errors="replace")
            raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}:\n{said}")


def peak_megabytes(pid: int) -> float:
    """Return the largest resident set that a process and the children it has now have had, MB (proc(5), VmHWM)."""
    kilobytes = 0
    for process in (pid, *children_of(pid)):
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                kilobytes += int(line.split()[1])
    return kilobytes / 1e3
