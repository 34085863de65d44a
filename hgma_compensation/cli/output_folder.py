"""A folder that a command fills: all of its files, or none of them."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hgma_compensation.cli import outputs
from hgma_compensation.errors import RefusedError


def check_output_folder(path: Path) -> None:
    """Raise RefusedError, before any work is done, where the folder cannot be made."""
    if path.exists() and not path.is_dir():
        raise RefusedError(f"{path} is a file: give the name of a folder")
    if not path.exists() and not path.parent.is_dir():
        raise RefusedError(f"{path.parent} is no directory: create it first")
    outputs.announce(path)


@contextmanager
def scratch_folder(path: Path) -> Iterator[Path]:
    """Give a folder beside ``path``; what the block writes into it is moved to ``path`` when it ends without an error.

    ``path`` is made where it is not there; files of the same name are replaced. Raises RefusedError where it cannot be.
    """
    try:
        scratch = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}."))
    except OSError as error:
        raise RefusedError(f"{path} cannot be made ({error.strerror}): choose another place") from None
    try:
        yield scratch
        path.mkdir(exist_ok=True)
        for file in sorted(scratch.iterdir()):
            os.replace(file, path / file.name)
    except OSError as error:
        raise RefusedError(f"{path} cannot be written ({error.strerror}): choose another place") from None
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
