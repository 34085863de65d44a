"""``hgma fleet``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click
from rich.table import Table
from rich.text import Text

from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.progress_bars import progress_bar
from hgma_compensation.cli.tables import new_table, show_table
from hgma_compensation.cli.training_options import settings_of, training_options
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically
from hgma_compensation.fleet.figures import BY_NAME, SUMMARISED, Figure
from hgma_compensation.fleet.limits import Limits, read_limits
from hgma_compensation.fleet.local_engine import cores
from hgma_compensation.fleet.options import FleetOptions
from hgma_compensation.fleet.run import (
    SUMMARY_CSV,
    SUMMARY_JSON,
    SUMMARY_PAGE,
    here,
    jobs_of,
    on_cluster,
    run_jobs,
)
from hgma_compensation.fleet.status import Status
from hgma_compensation.fleet.summary import State, Summary, summarise
from hgma_compensation.quantities import DIGITS, counted, number, shown_unit
from hgma_compensation.topics import TopicNames

SHOWN = 10
"""Sensors in the table of the terminal; all are in the files."""

WHY_UNKNOWN = "not defined: the recording is too short, or its temperature does not change"
INCOMPLETE, INTERRUPTED = 1, 130


@click.command("fleet", epilog="Example: hgma fleet sensors -o calibrated --limits params/acceptance.yaml")
@click.argument("folder", metavar="DIR", type=options.PathArgument())
@options.output("DIR", "Folder for a folder of each sensor, and the summary; made if it is not there.")
@training_options
@click.option(
    "--holdout",
    metavar="NAME",
    help="Recording of each sensor to judge on, such as second_oven or 2026-*. Default: the one named holdout* or "
    "accept*; where there is none the last of several, or the last quarter of a single one.",
)
@click.option(
    "--limits",
    "limits_path",
    metavar="FILE",
    type=options.PathArgument(),
    help="Acceptance limits, such as params/acceptance.yaml.",
)
@click.option("--workers", type=click.IntRange(1, 1000), help="Processes on this machine. Default: one for each core.")
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Dask scheduler whose workers calibrate instead; they must see both folders under the same paths.",
)
@options.remap
@options.json_file
def command(
    folder: Path,
    output: Path,
    holdout: str | None,
    limits_path: Path | None,
    workers: int | None,
    scheduler: str | None,
    names: TopicNames,
    json_path: Path | None,
    **chosen: Any,
) -> int:
    """Calibrate many sensors: one for each folder in DIR, named as the sensor, with its recordings in it.

    Each is trained as by `hgma train`, with the same seed, and judged on data that it was not fitted to. A sensor that
    cannot be calibrated does not stop the others. Given again, the command does only what is missing or has changed.
    Exit code 0: all were calibrated. 1: some could not be, the summary says why.
    """
    if workers is not None and scheduler is not None:
        raise RefusedError("--workers and --scheduler exclude each other: the workers are those of the cluster")
    limits = read_limits(limits_path) if limits_path is not None else Limits()
    settings = FleetOptions(settings_of(chosen), names, holdout)
    jobs = jobs_of(folder, output, settings)
    engine = on_cluster(scheduler) if scheduler is not None else here(min(workers or cores(), len(jobs)))
    ended = 0
    try:
        with progress_bar(f"{len(jobs)} sensors", len(jobs)) as (bar, task):

            def show(status: Status) -> None:
                nonlocal ended
                ended += 1
                bar.update(task, completed=ended, description=f"{ended} of {len(jobs)} sensors, {status.sensor}")

            statuses = run_jobs(jobs, engine, show)
    except KeyboardInterrupt:
        click.echo(
            f"interrupted: {ended} of {len(jobs)} sensors had ended, finished ones are kept; "
            "give the same command again to go on",
            err=True,
        )
        return INTERRUPTED
    summary = summarise(statuses, limits, settings)
    _write(summary, output, folder.resolve().name)
    _show(summary, output)
    write_json(json_path, summary.as_json())
    return INCOMPLETE if summary.failed else 0


def _write(summary: Summary, output: Path, name: str) -> None:
    from hgma_compensation.fleet.page import fleet_page  # brings matplotlib
    from hgma_compensation.fleet.table import summary_csv

    page = fleet_page(summary, f"Fleet {name}")
    write_atomically(output / SUMMARY_CSV, summary_csv(summary).encode())
    write_atomically(output / SUMMARY_PAGE, page.encode())
    content = json.dumps(summary.as_json(), indent=1, allow_nan=False) + "\n"
    write_atomically(output / SUMMARY_JSON, content.encode())


def _show(summary: Summary, output: Path) -> None:
    for channel in summary.channels:
        show_table(_table(summary, channel), WHY_UNKNOWN)
    for unit in summary.failed[:SHOWN]:
        click.echo(f"{unit.name}: not calibrated: {unit.status.reason}")
    if len(summary.failed) > SHOWN:
        click.echo(f"and {len(summary.failed) - SHOWN} more that could not be calibrated")
    for section in summary.unused:
        click.echo(f"note: no sensor has a channel that the limits for {section} judge")
    outlying = [unit.name for unit in summary.units if unit.outliers]
    if outlying:
        click.echo(f"unlike the rest: {', '.join(outlying[:SHOWN])}{' ...' if len(outlying) > SHOWN else ''}")
    counts = ", ".join(f"{summary.count(state)} {state.value}" for state in State if summary.count(state))
    share = summary.accepted_share
    said = "" if share is None else f"; yield {100.0 * share:.1f} %"
    click.echo(f"{output / SUMMARY_PAGE}: {counted(len(summary.units), 'sensor')}, {counts}{said}")


def _table(summary: Summary, channel: str) -> Table:
    """Return the worst sensors on a channel; the units stand in the headings, so that six figures fit into a line."""
    headings = [_heading(BY_NAME[name], channel) for name in SUMMARISED]
    title = f"{channel}: worst of {counted(len(summary.units), 'sensor')}, on data that none was fitted to"
    table = new_table(title, ("sensor", "state", *headings), numbers=headings)
    for unit in [unit for unit in summary.worst if channel in unit.status.channels][:SHOWN]:
        figures = unit.status.channels[channel]
        # A folder may have brackets in its name, which are markup in a plain string.
        table.add_row(
            Text(unit.name), unit.state.value, *(_cell(figures.get(name), BY_NAME[name]) for name in SUMMARISED)
        )
    return table


def _heading(figure: Figure, channel: str) -> str:
    return f"{figure.short}\n{shown_unit(figure.unit(unit_of(channel)))}".rstrip()


def _cell(value: float | None, figure: Figure) -> str:
    return number(value, figure.digits(DIGITS))
