"""``hgma simulate``."""

from pathlib import Path

import click

from hgma_compensation.cli import options, paths
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.outputs import check_new
from hgma_compensation.cli.progress_bars import counting_bar, progress_bar
from hgma_compensation.quantities import count, duration
from hgma_compensation.recording.bag_writer import Storage, write_recording
from hgma_compensation.simulation.oven_test import simulate_with_truth
from hgma_compensation.simulation.scenario import read_scenario


@click.command("simulate", epilog="Example: hgma simulate params/oven_test.yaml -o oven_test")
@click.argument("scenario", type=paths.ScenarioPath())
@options.output("BAG", "Recording to write.")
@options.storage
@options.json_file
def command(scenario: Path, output: Path, storage: Storage, json_path: Path | None) -> None:
    """Make the recording of an oven test out of a SCENARIO.yaml such as those in params/."""
    check_new(output)
    described = read_scenario(scenario)
    with progress_bar("simulating"):
        simulated = simulate_with_truth(described)
    recording, truth = simulated.recording, simulated.truth if described.ground_truth else None
    scalars = recording.temperature, recording.temperature_2, recording.supply_voltage
    messages = len(recording.stamps) // described.block + (0 if truth is None else 3 * len(recording.stamps))
    messages += sum(len(series.stamps) for series in scalars)
    with counting_bar("writing", messages) as advance:
        write_recording(recording, output, storage, advance, truth, described.block)
    click.echo(
        f"{output}: {count(len(recording.stamps))} samples over {duration(recording.duration)} "
        f"of {', '.join(recording.present)}"
    )
    figures = {"samples": len(recording.stamps), "duration": recording.duration, "channels": list(recording.present)}
    write_json(json_path, figures)
