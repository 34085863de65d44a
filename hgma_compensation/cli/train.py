"""``hgma train``."""

from pathlib import Path
from typing import Any

import click
from rich.table import Table

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.outputs import check_folder
from hgma_compensation.cli.progress_bars import counting_bar, progress_bar
from hgma_compensation.cli.recording_topics import declared_messages
from hgma_compensation.cli.report_option import report_option
from hgma_compensation.cli.tables import new_table, show_table
from hgma_compensation.cli.training_options import settings_of, training_options
from hgma_compensation.cli.training_page import report_training
from hgma_compensation.quantities import duration, quantity
from hgma_compensation.recording.streamed import open_recording
from hgma_compensation.report.search_record import SearchRecord
from hgma_compensation.topics import TopicNames
from hgma_compensation.training.train import choose_channels, train

FIGURES = ("fitted", "cross-validated", "noise")
WHY_UNKNOWN = "this method has no cross-validation"


@click.command("train", epilog="Example: hgma train oven_test -o calibration.json")
@options.bags_argument
@options.output("CAL", "Calibration file to write.")
@training_options
@click.option("--sensor-id", metavar="ID", help="Name of the sensor in the file. Default: the frame of its messages.")
@report_option("Also write a page for people: what was learned, all methods compared, what the recordings cover.")
@options.time_range
@options.remap
@options.json_file
def command(bags: tuple[Path, ...], output: Path, names: TopicNames, json_path: Path | None, **chosen: Any) -> int:
    """Fit a calibration to one or more recordings of the same still sensor."""
    check_folder(output)
    settings = settings_of(chosen, chosen["sensor_id"])
    with counting_bar("reading", declared_messages(bags, names)) as advance:
        recordings = [open_recording(bag, names, advance).cut(chosen["start"], chosen["end"]) for bag in bags]
    channels = choose_channels(recordings, settings.channels)
    search = SearchRecord()
    with progress_bar("training", len(channels) * settings.genetic.generations) as (bar, task):

        def show(channel: str, generation: int, best: float) -> None:
            search.add(channel, generation, best)
            done = channels.index(channel) * settings.genetic.generations + generation
            bar.update(task, completed=done, description=f"{channel}: best {quantity(best, unit_of(channel))}")

        calibration = train(recordings, settings, show)
    write_calibration(calibration, output)
    show_table(_table(calibration), WHY_UNKNOWN)
    click.echo(f"{output}: calibration {calibration.calibration_id} of sensor {calibration.sensor_id}")
    write_json(json_path, _figures(calibration))
    if chosen["report"] is None:
        return 0
    return report_training(recordings, calibration, settings.genetic, search, (bags, output, chosen["report"]))


def _table(calibration: Calibration) -> Table:
    title = f"RMS over means of {duration(calibration.training['block'])} ({calibration.training['folds']})"
    table = new_table(title, ("channel", *FIGURES), numbers=FIGURES)
    for channel in calibration.channels:
        error, unit = channel.error, unit_of(channel.name)
        figures = (error.fit, error.cross_validated, error.noise)
        table.add_row(channel.name, *(quantity(figure, unit) for figure in figures))
    return table


def _figures(calibration: Calibration) -> dict[str, Any]:
    return {
        "calibration_id": calibration.calibration_id,
        "sensor_id": calibration.sensor_id,
        "block": calibration.training["block"],
        "folds": calibration.training["folds"],
        "channels": {
            channel.name: {
                "unit": unit_of(channel.name),
                "reference": channel.reference,
                "fit": channel.error.fit,
                "cross_validated": channel.error.cross_validated,
                "noise": channel.error.noise,
            }
            for channel in calibration.channels
        },
    }
