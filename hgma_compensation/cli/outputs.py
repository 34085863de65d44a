"""What a command was asked to write: refused before any work is done, and remembered.

So that an interruption tells the truth about it.
"""

from pathlib import Path

from hgma_compensation.errors import RefusedError
from hgma_compensation.files import check_regular

STANDARD_OUTPUT = Path("-")
"""As the FILE of --json: standard output, which then holds nothing else."""

_Signature = tuple[int, int] | None

_announced: dict[Path, _Signature] = {}


def begin() -> None:
    """Forget the outputs of the command before."""
    _announced.clear()


def announce(path: Path) -> None:
    """Remember how an output looks before the work begins."""
    _announced.setdefault(path, _signature(path))


def written() -> list[Path]:
    """Return the outputs that have changed since they were announced."""
    return [path for path, before in _announced.items() if _signature(path) not in (before, None)]


def _signature(path: Path) -> _Signature:
    """Return what changes when a file is replaced or a folder is made; None where there is nothing."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_ino, status.st_mtime_ns


def check_new(path: Path) -> None:
    """Raise RefusedError, before any work is done, where an output would overwrite a bag or has no folder."""
    if path.exists():
        raise RefusedError(f"{path} exists: choose another name or remove it")
    check_folder(path)


def check_folder(path: Path) -> None:
    """Raise RefusedError where the folder that a file is to be written to does not exist."""
    if not path.parent.is_dir():
        raise RefusedError(f"{path.parent} is no directory: create it first")
    if path.is_dir():
        raise RefusedError(f"{path} is a directory: give the name of a file")
    if path == STANDARD_OUTPUT:
        raise RefusedError(f"{path} is no name of a file: only --json takes it, for standard output")
    check_regular(path)
    announce(path)
