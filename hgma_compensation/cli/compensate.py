"""``hgma compensate``."""

from pathlib import Path

import click

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.outputs import check_new
from hgma_compensation.cli.progress_bars import progress_bar
from hgma_compensation.cli.recording_topics import declared_messages
from hgma_compensation.pipeline.state_rate import DEFAULT_RATE
from hgma_compensation.quantities import count
from hgma_compensation.recording.bag_writer import Storage
from hgma_compensation.recording.compensated_copy import write_compensated
from hgma_compensation.topics import TopicNames


@click.command("compensate", epilog="Example: hgma compensate oven_test --calibration calibration.json -o compensated")
@options.bag_argument
@options.calibration
@options.output("BAG", "Recording to write: all topics of the first, with the compensated ones added.")
@options.storage
@click.option(
    "--state-rate",
    type=click.FloatRange(min=0.0),
    default=DEFAULT_RATE,
    show_default=True,
    metavar="HZ",
    help="States in a second at the most, besides those of change; 0 for one with every message.",
)
@options.remap
@options.json_file
def command(
    bag: Path,
    calibration: Path,
    output: Path,
    storage: Storage,
    state_rate: float,
    names: TopicNames,
    json_path: Path | None,
) -> None:
    """Compensate a recording with the node's pipeline, without ROS."""
    check_new(output)
    model = read_calibration(calibration)
    with progress_bar("compensating", declared_messages([bag], names)) as (shown, task):

        def show(done: int, total: int) -> None:
            shown.update(task, advance=done, total=total)

        copied = write_compensated(
            bag, model, output, names=names, storage=storage, state_rate=state_rate, progress=show
        )
    figures = {
        "calibration_id": model.calibration_id,
        "samples": copied.samples,
        "compensated": copied.compensated,
        "skipped_not_finite": copied.samples - copied.compensated,
        "outside_calibrated_range": copied.outside_range,
    }
    click.echo(
        f"{output}: {count(copied.compensated)} of {count(copied.samples)} samples compensated with "
        f"{model.calibration_id}, {count(copied.outside_range)} of them outside the calibrated range"
    )
    write_json(json_path, figures)
