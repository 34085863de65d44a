"""Processes that a process has started, out of /proc (proc(5))."""

import time
from pathlib import Path


def children_of(pid):
    """Return the numbers of the living children of a process."""
    return [number for number, parent, state in _processes() if parent == pid and state not in "ZX"]


def only_child_of(pid, timeout=10.0):
    """Wait until a process has a child, and return the number of the only one."""
    end = time.monotonic() + timeout
    while not (children := children_of(pid)):
        assert time.monotonic() < end, f"process {pid} has no child"
        time.sleep(0.01)
    (child,) = children
    return child


def wait_until_gone(pid, timeout=10.0):
    """Wait until a process has ended."""
    end = time.monotonic() + timeout
    while any(number == pid and state not in "ZX" for number, _, state in _processes()):
        assert time.monotonic() < end, f"process {pid} still runs"
        time.sleep(0.01)


def _processes():
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            content = path.read_text()
        except (FileNotFoundError, ProcessLookupError):
            continue
        state, parent = content[content.rindex(")") + 2 :].split()[:2]
        yield int(path.parent.name), int(parent), state
