"""Reading a file that somebody else names: regular, bounded, and where it is allowed to lie."""

import os
import stat
from pathlib import Path

from hgma_compensation.errors import RefusedError


def read_regular_file(path: Path, largest: int, directory: Path | None = None) -> bytes:
    """Return the content of a regular file of at most ``largest`` bytes, symbolic links followed.

    directory: where the file itself, after all links, must lie; None for anywhere. Linux only (/proc). Raises
    RefusedError, without the path, for anything else; nothing but a regular file is ever opened for reading, so that
    no device is started and no pipe meets its writer.
    """
    place = _open(path, os.O_PATH)
    try:
        status = os.fstat(place)
        if not stat.S_ISREG(status.st_mode):
            raise RefusedError("is not a regular file: give the JSON file written by hgma train")
        if status.st_size > largest:
            raise RefusedError(f"has {status.st_size} bytes, more than {largest}: this is not a calibration")
        if directory is not None:
            _check_place(place, directory)
        # The descriptor's own entry leads to the very file that was examined, whatever the path leads to by now.
        return _read(Path(_entry(place)), status.st_size)
    finally:
        os.close(place)


def _entry(descriptor: int) -> str:
    return f"/proc/self/fd/{descriptor}"


def _open(path: Path, flags: int) -> int:
    try:
        return os.open(path, flags | os.O_CLOEXEC)
    except OSError as error:
        raise RefusedError(
            f"cannot be opened ({error.strerror}){_hint(path)}: check the path and its permissions"
        ) from None
    except ValueError:
        raise RefusedError("is no path (it holds a NUL or half a character): check the path") from None


def _hint(path: Path) -> str:
    """Return where a path that is not absolute was looked for."""
    if Path(path).is_absolute():
        return ""
    return f" in {os.getcwd()}, where ~ is not expanded" if str(path).startswith("~") else f" in {os.getcwd()}"


def _check_place(place: int, directory: Path) -> None:
    try:
        real = Path(os.readlink(_entry(place)))
        allowed = directory.resolve(strict=True)
    except (OSError, RuntimeError, ValueError):
        raise RefusedError(
            f"cannot be told to lie in the calibration directory {directory}: check that this directory exists"
        ) from None
    if not real.is_relative_to(allowed):
        raise RefusedError(
            f"lies at {real}, outside of the calibration directory {allowed}: copy it there, or set "
            "calibration_directory otherwise"
        )


def _read(path: Path, size: int) -> bytes:
    descriptor = _open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            # Never more than its size: some files of the kernel have none, and block, or never end, once they are read.
            return file.read(size)
    except OSError as error:
        raise RefusedError(f"cannot be read ({error.strerror}): copy it again") from None
    finally:
        os.close(descriptor)
