"""Free memory that stays with the process, or does not."""

import ctypes
import gc
from contextlib import suppress

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""Numbers of glibc's malloc.h."""

KEPT = 64 << 20
"""Bytes of free memory that stay with the process: some blocks of a hundred thousand samples."""


RETURNED = 1 << 18
"""Bytes of an array from which on it goes back once it is freed."""


def keep_memory() -> None:
    """Let the memory of a block serve the next one; glibc would give it back each time, and have it cleared anew.

    What has been loaded until now is not looked through any more for objects that nothing refers to.
    """
    gc.freeze()
    _set(M_TRIM_THRESHOLD, KEPT)
    _set(M_MMAP_THRESHOLD, KEPT)


def return_memory() -> None:
    """Let large arrays go back to the system one by one; glibc would keep the like of what was freed, in pieces."""
    _set(M_MMAP_THRESHOLD, RETURNED)


def give_back() -> None:
    """Give the free memory between what is in use back to the system, of which glibc gives back the end alone."""
    with suppress(OSError, AttributeError):  # another libc has no such function
        ctypes.CDLL(None).malloc_trim(0)


def _set(parameter: int, size: int) -> None:
    with suppress(OSError, AttributeError):  # another libc has no such settings
        ctypes.CDLL(None).mallopt(parameter, size)
