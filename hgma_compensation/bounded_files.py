"""Opens files that come from outside: regular ones only, and never more of them than was asked for."""

import os
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, TextIO

from hgma_compensation.errors import RefusedError

LONGEST_LINE = 1 << 20
"""Characters: a line is held in memory whole, and a file of zeros has none that ends."""


def open_regular(path: Path) -> BinaryIO:
    """Return a regular file opened for reading; symbolic links are followed.

    Raises RefusedError for anything else: a pipe would be waited for, a device has no end.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = error.strerror if isinstance(error, OSError) else error
        raise RefusedError(f"{path} cannot be read ({reason}): check the path and its permissions") from None
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise RefusedError(f"{path} is not a regular file: give the file itself")
    return os.fdopen(descriptor, "rb")


def read_text(path: Path, largest: int) -> str:
    """Return a UTF-8 file of at most ``largest`` bytes; raises RefusedError for any other."""
    with open_regular(path) as file:
        try:
            content = file.read(largest + 1)
        except OSError as error:
            raise RefusedError(f"{path} cannot be read ({error.strerror}): copy it again") from None
    if len(content) > largest:
        raise RefusedError(f"{path} is larger than {largest} bytes: this is not what it should be, or cut it")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        raise RefusedError(f"{path} is not UTF-8 text: save it as such") from None


def lines_of(file: TextIO, path: Path) -> Iterator[str]:
    """Yield the lines of a text; raises RefusedError for one that is longer than LONGEST_LINE."""
    while line := file.readline(LONGEST_LINE):
        if len(line) == LONGEST_LINE and not line.endswith("\n"):
            raise RefusedError(f"{path} has a line of {LONGEST_LINE} characters or more: this is no table")
        yield line
