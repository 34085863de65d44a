"""Options that several commands share, and their conversion."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from hgma_compensation.recording.bag_writer import Storage
from hgma_compensation.topics import TopicNames

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


class PathArgument(click.Path):
    """A path as a pathlib.Path; whether it exists is said by whoever opens it, with the remedy."""

    def __init__(self) -> None:
        """Accept any path."""
        super().__init__(path_type=Path)


def bag_argument(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument BAG."""
    return click.argument("bag", type=PathArgument())(function)


def bags_argument(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument BAG..., one or more."""
    return click.argument("bags", metavar="BAG...", nargs=-1, required=True, type=PathArgument())(function)


def output(metavar: str, text: str) -> Decorator:
    """Add the required option -o."""
    return click.option("-o", "--output", required=True, metavar=metavar, type=PathArgument(), help=text)


def calibration(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the required option --calibration."""
    return click.option(
        "--calibration",
        required=True,
        metavar="CAL",
        type=PathArgument(),
        help="Calibration file of hgma train.",
    )(function)


def json_file(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option --json."""
    return click.option(
        "--json", "json_path", metavar="FILE", type=PathArgument(), help="Also write the figures to FILE."
    )(function)


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
