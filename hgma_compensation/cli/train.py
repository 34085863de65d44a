"""``hgma train``."""

from pathlib import Path
from typing import Any

import click
from rich.table import Table

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.terminal import check_folder, console, counting_bar, progress_bar, write_json
from hgma_compensation.cli.training_options import settings_of, training_options
from hgma_compensation.recording.streamed import open_recording
from hgma_compensation.topics import TopicNames
from hgma_compensation.training.train import choose_channels, train


@click.command("train")
@options.bags_argument
@options.output("CAL", "Calibration file to write.")
@training_options
@click.option("--sensor-id", metavar="ID", help="Name of the sensor in the file. Default: the frame of its messages.")
@options.time_range
@options.remap
@options.json_file
def command(bags: tuple[Path, ...], output: Path, names: TopicNames, json_path: Path | None, **chosen: Any) -> None:
    """Fit a calibration to one or more recordings of the same still sensor."""
    check_folder(output)
    settings = settings_of(chosen, chosen["sensor_id"])
    with counting_bar("reading") as advance:
        recordings = [open_recording(bag, names, advance).cut(chosen["start"], chosen["end"]) for bag in bags]
    channels = choose_channels(recordings, settings.channels)
    with progress_bar("training", len(channels) * settings.genetic.generations) as (bar, task):

        def show(channel: str, generation: int, best: float) -> None:
            done = channels.index(channel) * settings.genetic.generations + generation
            bar.update(task, completed=done, description=f"{channel}: best {best:.4g} {unit_of(channel)}")

        calibration = train(recordings, settings, show)
    write_calibration(calibration, output)
    console.print(_table(calibration))
    click.echo(f"{output}: calibration {calibration.calibration_id} of sensor {calibration.sensor_id}")
    write_json(json_path, _figures(calibration))


def _table(calibration: Calibration) -> Table:
    table = Table(title=f"RMS over means of {calibration.training['block']:g} s ({calibration.training['folds']})")
    for heading in ("channel", "unit", "fitted", "cross-validated", "noise"):
        table.add_column(heading, justify="left" if heading in ("channel", "unit") else "right")
    for channel in calibration.channels:
        validated = channel.error.cross_validated
        table.add_row(
            channel.name,
            unit_of(channel.name),
            f"{channel.error.fit:.4g}",
            "-" if validated is None else f"{validated:.4g}",
            f"{channel.error.noise:.4g}",
        )
    return table


def _figures(calibration: Calibration) -> dict[str, Any]:
    return {
        "calibration_id": calibration.calibration_id,
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
