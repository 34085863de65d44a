"""The figures of a command as JSON, to a file or to standard output."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any, TextIO

import click

from hgma_compensation.cli.outputs import STANDARD_OUTPUT, check_folder
from hgma_compensation.files import write_atomically

_STREAM = "hgma_compensation.standard_output"


@contextmanager
def figures_to(path: Path | None) -> Iterator[None]:
    """Prepare for ``write_json`` while a command runs: to standard output, people's text goes to standard error.

    Raises RefusedError, before any work is done, where the file cannot be written.
    """
    if path == STANDARD_OUTPUT:
        click.get_current_context().meta[_STREAM] = sys.stdout
        with redirect_stdout(sys.stderr):
            yield
        return
    if path is not None:
        check_folder(path)
    yield


def write_json(path: Path | None, figures: dict[str, Any]) -> None:
    """Write the figures of a command, if it was asked to; to standard output where the path is "-"."""
    if path is None:
        return
    text = json.dumps(figures, indent=1, allow_nan=False) + "\n"
    if path == STANDARD_OUTPUT:
        stream: TextIO = click.get_current_context().meta.get(_STREAM) or sys.stdout
        stream.write(text)
        stream.flush()
    else:
        write_atomically(path, text.encode())
