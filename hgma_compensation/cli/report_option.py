"""The option ``--report`` of commands that can write a page, checked before any work is done."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from hgma_compensation.cli.options import PathArgument
from hgma_compensation.cli.outputs import check_folder
from hgma_compensation.errors import RefusedError

SUFFIXES = (".html", ".htm")


def report_option(text: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return the option --report, given to the command as ``report``; text: what the page holds."""
    return click.option("--report", metavar="FILE.html", type=PathArgument(), callback=_checked, help=text)


def _checked(_context: click.Context, _parameter: click.Parameter, path: Path | None) -> Path | None:
    """Return the path; a slip of the hand must not replace a calibration by a page."""
    if path is None:
        return None
    if path.suffix.lower() not in SUFFIXES:
        raise RefusedError(f"--report {path}: give the name of a page, such as {path.with_suffix('.html').name}")
    check_folder(path)
    return path
