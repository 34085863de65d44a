"""``hgma`` alone: what to do next in this folder."""

import os
import sys
from collections.abc import Collection
from pathlib import Path

import click

from hgma_compensation.cli.folder import look
from hgma_compensation.cli.next_step import lines

EXAMPLE = Path("params") / "oven_test.yaml"


def show_next_steps(commands: Collection[str]) -> None:
    """Print what lies in the present folder and the commands that go on from it."""
    for line in lines(look(), commands, shipped_scenario()):
        click.echo(line)


def shipped_scenario() -> Path | None:
    """Return the path of the example that comes with the package, short where it lies below the present folder."""
    source, installed = Path(__file__).parents[2], Path(sys.prefix) / "share" / "hgma_compensation"
    prefixes = [Path(one) / "share" / "hgma_compensation" for one in os.environ.get("AMENT_PREFIX_PATH", "").split(":")]
    for folder in (source, installed, *prefixes):
        if (folder / EXAMPLE).is_file():
            path = folder / EXAMPLE
            return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
    return None
