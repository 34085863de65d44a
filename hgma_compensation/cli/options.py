"""Options that several commands share, and their conversion."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from hgma_compensation.cli.json_figures import figures_to
from hgma_compensation.cli.outputs import STANDARD_OUTPUT
from hgma_compensation.cli.paths import CalibrationPath, PathArgument, RecordingPath
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.bag_writer import Storage
from hgma_compensation.topics import TopicNames

__all__ = [
    "PathArgument",
    "bag_argument",
    "bags_argument",
    "calibration",
    "json_file",
    "output",
    "reference",
    "remap",
    "storage",
    "time_range",
]

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def bag_argument(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument BAG."""
    return click.argument("bag", type=RecordingPath())(function)


def bags_argument(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument BAG..., one or more."""
    return click.argument("bags", metavar="BAG...", nargs=-1, required=True, type=RecordingPath(), callback=_each_once)(
        function
    )


def _each_once(_ctx: click.Context, _parameter: click.Parameter, bags: tuple[Path, ...]) -> tuple[Path, ...]:
    places = [bag.resolve() for bag in bags]
    for number, place in enumerate(places):
        if place in places[:number]:
            raise RefusedError(f"bag {bags[number]} is given twice: give each recording once")
    return bags


def output(metavar: str, text: str) -> Decorator:
    """Add the required option -o."""
    return click.option("-o", "--output", required=True, metavar=metavar, type=PathArgument(), help=text)


def calibration(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the required option --calibration."""
    return click.option(
        "--calibration",
        required=True,
        metavar="CAL",
        type=CalibrationPath(),
        help="Calibration file of hgma train.",
    )(function)


def json_file(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option --json; the command is given ``json_path`` and hands it to ``write_json``.

    While the command runs with ``--json -``, what it prints goes to standard error.
    """

    @functools.wraps(function)
    def with_figures(*arguments: Any, **chosen: Any) -> Any:
        path = chosen["json_path"]
        _check_other(path, chosen)
        with figures_to(path):
            return function(*arguments, **chosen)

    return click.option(
        "--json",
        "json_path",
        metavar="FILE",
        type=PathArgument(),
        help="Also write the figures to FILE; - for standard output, what is told goes to standard error then.",
    )(with_figures)


def _check_other(path: Path | None, chosen: dict[str, Any]) -> None:
    """Raise RefusedError where the figures would be written over another file of the command."""
    if path is None or path == STANDARD_OUTPUT:
        return
    for name, given in chosen.items():
        for other in given if isinstance(given, tuple) else (given,):
            if name != "json_path" and isinstance(other, Path) and other.resolve() == path.resolve():
                raise RefusedError(f"--json {path} is another file of this command: give it a name of its own")


def reference(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option --reference."""
    return click.option(
        "--reference",
        "reference_text",
        default="mean",
        show_default=True,
        metavar="X[,Y,Z]|mean",
        help="True still values in the channel's unit; one serves all. "
        "mean: the recording's own mean, so that only drift counts.",
    )(function)


def remap(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option --remap, given to the command as ``names``."""
    return click.option(
        "--remap",
        "names",
        multiple=True,
        metavar="A:=B",
        callback=lambda _ctx, _parameter, rules: TopicNames(rules),
        help="Topic A of the node is called B in the bag. May be repeated.",
    )(function)


def time_range(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options --from and --until."""
    function = click.option(
        "--until", "end", type=float, metavar="S", help="Only samples before S seconds from the start."
    )(function)
    return click.option("--from", "start", type=float, metavar="S", help="Only samples from S seconds on.")(function)


def storage(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option --storage."""
    return click.option(
        "--storage",
        type=click.Choice([kind.value for kind in Storage]),
        default=Storage.MCAP.value,
        show_default=True,
        callback=lambda _ctx, _parameter, value: Storage(value),
        help="Format of the bag that is written.",
    )(function)
