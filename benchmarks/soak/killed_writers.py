"""Processes that do nothing but write a state file, killed at any microsecond."""

import os
import random
import signal
import time
from itertools import count
from pathlib import Path

from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.state_file import read_state, remove_litter, write_state

LONGEST = 0.04
"""s after which a writer is killed at the latest: it writes a few files in that time."""


def kill_writers(live: LiveCompensation, path: Path, kills: int, seed: int) -> dict[str, int]:
    """Return how many writers were killed, how many of them while writing, and how many states were found.

    Raises RefusedError where a file does not load.
    """
    moments = random.Random(seed)
    write_state(live.snapshot(), path, lambda: None)
    interrupted = states = 0
    last: int | None = None
    for kill in range(kills):
        writer = _start(live, path, kill)
        time.sleep(moments.uniform(0.0, LONGEST))
        os.kill(writer, signal.SIGKILL)
        os.waitpid(writer, 0)
        state = read_state(path)
        assert state is not None
        states += state.acceleration != last
        last = state.acceleration
        interrupted += remove_litter(path)
    return {"writers_killed": kills, "while_writing": interrupted, "states_seen": states, "files_that_load": kills}


def _start(live: LiveCompensation, path: Path, kill: int) -> int:
    """Fork a process that writes states for ever, each with a stamp of its own."""
    writer = os.fork()
    if writer:
        return writer
    state = live.snapshot()
    for number in count():
        object.__setattr__(state, "acceleration", kill * 1_000_000 + number)
        write_state(state, path, lambda: None)
    raise AssertionError
