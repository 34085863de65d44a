"""The page of ``hgma train``, made once the calibration is written."""

from collections.abc import Sequence
from pathlib import Path

import click

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.cli.main import INTERRUPTED
from hgma_compensation.cli.progress_bars import progress_bar
from hgma_compensation.recording.source import Source
from hgma_compensation.report.search_record import SearchRecord
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.methods import Method


def report_training(
    recordings: Sequence[Source],
    calibration: Calibration,
    settings: GeneticSettings,
    search: SearchRecord,
    files: tuple[Sequence[Path], Path, Path],
) -> int:
    """Compare the methods on the recordings and write the page; files: bags, calibration, page. Return the exit code.

    The calibration is written already, so an interruption here must not say that nothing was.
    """
    from hgma_compensation.report.training_report import write_training_report  # brings matplotlib
    from hgma_compensation.report.training_result import training_result

    bags, calibration_file, page = files
    try:
        with progress_bar("comparing methods", len(Method) * len(calibration.channels)) as (bar, task):

            def show(channel: str, method: Method) -> None:
                bar.update(task, advance=1, description=f"{channel}: {method.value} compared")

            result = training_result(recordings, calibration, settings, search, show)
        write_training_report(result, bags, calibration_file, page)
    except KeyboardInterrupt:
        click.echo(f"interrupted: {calibration_file} is written, {page} is not", err=True)
        return INTERRUPTED
    click.echo(f"{page}: report")
    return 0
