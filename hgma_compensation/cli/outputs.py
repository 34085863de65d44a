"""What a command was asked to write, so that an interruption tells the truth about it."""

from pathlib import Path

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
