"""ROS domains that no two processes of this machine share."""

import fcntl
import os
import random
import tempfile
from pathlib import Path

DOMAINS = range(1, 101)
"""Those whose ports lie below the ephemeral ones of Linux."""

_held: list[int] = []
"""Descriptors of the locked files: closing one would give its domain away."""


def take_domain() -> int:
    """Return a domain that is this process's own until it ends; another one at each call.

    Each domain has a file in the folder for temporary ones, which its owner keeps locked; the system unlocks it when
    the process ends, however that happens. Raises RuntimeError where all domains are taken.
    """
    # In random order, so as to keep clear of programs that do not ask for locks as well.
    for domain in random.SystemRandom().sample(DOMAINS, len(DOMAINS)):
        descriptor = _lock(Path(tempfile.gettempdir()) / f"hgma_ros_domain_{domain}.lock")
        if descriptor is not None:
            _held.append(descriptor)
            return domain
    raise RuntimeError("all ROS domains are taken: wait until other runs have ended, or set ROS_DOMAIN_ID")


def held() -> int:
    """Return how many domains this process holds."""
    return len(_held)


def give_back(kept: int) -> None:
    """Give up the domains that were taken after the first ``kept``; nothing may talk there any more."""
    while len(_held) > kept:
        os.close(_held.pop())


def _lock(path: Path) -> int | None:
    """Return the descriptor of a locked file, None where another process, or another user, has it."""
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    except OSError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        return None
    return descriptor
