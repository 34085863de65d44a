"""Commands run to their end, with their wall time and peak memory."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

TIMED = Path(__file__).with_name("timed.py")


@dataclass(frozen=True)
class Run:
    """seconds: wall time. peak_megabytes: largest resident set."""

    seconds: float
    peak_megabytes: float


def run(command: Sequence[str | Path]) -> Run:
    """Run a command to its end; raises RuntimeError with what it said where it fails."""
    os.sync()  # so that nobody pays for what the run before has left to be written
    # -S: without the site packages' start-up code, which would make the parent large.
    words = [sys.executable, "-S", str(TIMED), *map(str, command)]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return Run(**json.loads(done.stdout.strip().splitlines()[-1]))


def run_writing(output: Path, command: Sequence[str | Path]) -> Run:
    """Run a command that writes a file or a folder, which is removed again."""
    try:
        return run(command)
    finally:
        if output.is_dir():
            shutil.rmtree(output)
        output.unlink(missing_ok=True)
