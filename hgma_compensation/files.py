"""Files that appear whole or not at all."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from hgma_compensation.errors import RefusedError


def check_regular(path: Path) -> None:
    """Raise RefusedError where there is a device or a pipe: a file would take its place."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise RefusedError(f"{path} is a device or a pipe: give the name of a file")


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that a reader sees the old one or the new one, also after a power cut.

    Raises RefusedError where it cannot be written.
    """
    import tempfile  # takes long to load, and the start of a node writes nothing

    path = Path(path)
    check_regular(path)
    try:
        descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise RefusedError(f"{path} cannot be written ({error.strerror}): choose another place") from None
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)
        os.replace(name, path)
    except OSError as error:
        raise RefusedError(f"{path} cannot be written ({error.strerror}): choose another place") from None
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(name)


@contextlib.contextmanager
def new_directory(path: Path) -> Iterator[Path]:
    """Give a scratch path beside ``path``; it is moved there when the block ends without an error.

    The block creates the directory. Raises RefusedError where ``path`` exists: nothing is overwritten.
    """
    import shutil
    import tempfile

    path = Path(path)
    if path.exists():
        raise RefusedError(f"{path} exists: choose another name or remove it")
    if not path.parent.is_dir():
        raise RefusedError(f"{path.parent} is no directory: create it first")
    try:
        scratch = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}."))
    except OSError as error:
        raise RefusedError(f"{path} cannot be written ({error.strerror}): choose another place") from None
    try:
        inner = scratch / path.name
        yield inner
        os.replace(inner, path)
    except OSError as error:
        raise RefusedError(f"{path} cannot be written ({error.strerror}): choose another place") from None
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
