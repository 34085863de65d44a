"""Free memory that stays with the process."""

import ctypes
from contextlib import suppress

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""Numbers of glibc's malloc.h."""

KEPT = 64 << 20
"""Bytes of free memory that stay with the process: some blocks of a hundred thousand samples."""


def keep_memory() -> None:
    """Let the memory of a block serve the next one; glibc would give it back each time, and have it cleared anew."""
    with suppress(OSError, AttributeError):  # another libc has no such settings
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(M_TRIM_THRESHOLD, KEPT)
        mallopt(M_MMAP_THRESHOLD, KEPT)
