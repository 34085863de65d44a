"""``hgma watch``."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click
from rich.console import Group, RenderableType
from rich.live import Live
from rich.text import Text

from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.ros_node import ros_node, ros_required
from hgma_compensation.cli.tables import console, new_table
from hgma_compensation.errors import RefusedError
from hgma_compensation.quantities import UNKNOWN, number, shown_unit
from hgma_compensation.topics import TopicNames
from hgma_compensation.watching import view
from hgma_compensation.watching.window import Window

PERIOD = 1.0
"""s between two looks."""

FIGURES = ("raw", "drift", "compensated", "deviation", "uncertainty")
HEADINGS = ("raw", "drift", "compensated", "spread", "drift ±")
WHY_UNKNOWN = "nothing of that kind has come within the last second"


@click.command("watch", epilog="Example: hgma watch --remap /accel/raw:=/imu/data_raw")
@click.option(
    "--seconds",
    type=click.FloatRange(min=0.0, min_open=True),
    metavar="S",
    help="Watch for S seconds; else until interrupted.",
)
@click.option("--namespace", default="", metavar="NS", help="Namespace that the node runs in.")
@options.remap
@options.json_file
def command(seconds: float | None, namespace: str, names: TopicNames, json_path: Path | None) -> None:
    """Show what a running node receives and publishes: raw and compensated acceleration, temperature, status.

    A table that is drawn anew on a terminal, a line each second elsewhere. For a robot without a screen of its own;
    with one, rqt_plot and Foxglove show the same topics.
    """
    with ros_required():
        from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

        from hgma_compensation.node.watcher import Watcher
    prefix = _prefix(namespace)
    shown = _Screen()
    begin = time.monotonic()
    try:
        with ros_node("hgma_watch") as node, closing_executor(SingleThreadedExecutor(), node) as executor, shown:
            watcher = Watcher(node, lambda topic: prefix + names[topic])
            while seconds is None or time.monotonic() - begin < seconds:
                until = time.monotonic() + PERIOD
                start = time.monotonic()
                while (left := until - time.monotonic()) > 0.0:
                    executor.spin_once(timeout_sec=left)
                window = watcher.take()
                shown.show(window, time.monotonic() - start, watcher.advice(window))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    write_json(json_path, shown.last)


def _prefix(namespace: str) -> str:
    """Return what stands before the topics of a node in a namespace; raises RefusedError where there can be none."""
    from rclpy.exceptions import InvalidNamespaceException
    from rclpy.validate_namespace import validate_namespace

    prefix = f"/{namespace.strip('/')}" if namespace.strip("/") else ""
    try:
        validate_namespace(prefix or "/")
    except InvalidNamespaceException:
        raise RefusedError(
            f"--namespace {namespace}: give the node's namespace, words of letters, digits and _ with / between"
        ) from None
    return prefix


@contextmanager
def closing_executor(executor: Any, node: Any) -> Iterator[Any]:
    """Give an executor that spins the node, and shut it down after it."""
    executor.add_node(node)
    try:
        yield executor
    finally:
        executor.shutdown()


class _Screen:
    """A table that is drawn anew on a terminal, lines where output goes to a file."""

    def __init__(self) -> None:
        self.last: dict[str, Any] = view.figures(Window(), PERIOD)
        self._live = Live(console=console, auto_refresh=False) if console.is_terminal else None

    def __enter__(self) -> "_Screen":
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def show(self, window: Window, seconds: float, advice: str) -> None:
        """Show a window of some seconds."""
        self.last = view.figures(window, seconds)
        if self._live is not None:
            self._live.update(live_table(self.last, advice), refresh=True)
        else:
            click.echo(view.line(self.last) + (f" | {advice}" if advice else ""))


def live_table(seen: dict[str, Any], advice: str) -> RenderableType:
    """Return the figures for a terminal that is drawn anew; advice: what to do where something does not come."""
    title = "Means over the last second; spread of samples, drift ± its standard deviation"
    table = new_table(title, ("channel", "unit", *HEADINGS), numbers=HEADINGS)
    for name, channel in seen["channels"].items():
        table.add_row(name, shown_unit(unit_of(name)), *(number(channel[key]) for key in FIGURES))
    unknown = any(channel[key] is None for channel in seen["channels"].values() for key in FIGURES)
    below = [Text(f"{UNKNOWN}: {WHY_UNKNOWN}")] if unknown else []
    below += [Text(view.line(seen))]
    return Group(table, *below, *([Text(advice, style="yellow")] if advice else []))
