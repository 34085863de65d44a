"""``hgma compensate``."""

from pathlib import Path

import click
import numpy as np

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.cli import options
from hgma_compensation.cli.terminal import check_new, counting_bar, write_json
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import Storage
from hgma_compensation.recording.compensated_bag import check_covered, write_compensated
from hgma_compensation.topics import TopicNames


@click.command("compensate")
@options.bag_argument
@options.calibration
@options.output("BAG", "Recording to write: all topics of the first, with the compensated ones added.")
@options.storage
@options.remap
@options.json_file
def command(
    bag: Path, calibration: Path, output: Path, storage: Storage, names: TopicNames, json_path: Path | None
) -> None:
    """Compensate a recording with the node's pipeline, without ROS."""
    check_new(output)
    model = read_calibration(calibration)
    with counting_bar("reading") as advance:
        recording = read_recording(bag, names, advance)
    check_covered(recording, model)
    with counting_bar("writing", len(recording.stamps) + len(recording.temperature.stamps)) as advance:
        result = write_compensated(bag, recording, model, output, names=names, storage=storage, progress=advance)
    figures = {
        "calibration_id": model.calibration_id,
        "samples": len(recording.stamps),
        "compensated": len(result.values),
        "skipped_not_finite": len(recording.stamps) - len(result.values),
        "outside_calibrated_range": int(np.count_nonzero(~result.inside_range)),
    }
    click.echo(
        f"{output}: {figures['compensated']} of {figures['samples']} samples compensated with {model.calibration_id}, "
        f"{figures['outside_calibrated_range']} of them outside the calibrated range"
    )
    write_json(json_path, figures)
