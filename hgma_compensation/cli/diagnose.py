"""``hgma diagnose``."""

import json
from pathlib import Path
from typing import Any

import click
from rich.table import Table

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.document import read_calibration, write_calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.output_folder import check_output_folder, scratch_folder
from hgma_compensation.cli.paths import RecordingPath
from hgma_compensation.cli.progress_bars import counting_bar, progress_bar
from hgma_compensation.cli.recording_topics import declared_messages
from hgma_compensation.cli.tables import console, new_table
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.diagnosis.result import ChannelDiagnosis, Diagnosis
from hgma_compensation.diagnosis.verdict import Verdict
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.registry import kinds
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically
from hgma_compensation.kept_memory import return_memory
from hgma_compensation.quantities import quantity
from hgma_compensation.recording.filed import FiledRecording, file_recording
from hgma_compensation.topics import TopicNames

STEPS = 6
"""Of one channel, as the progress bar counts them: preparing, three effects and the search for a fourth, judging."""

CALIBRATION, FIGURES, REPORT = "calibration.json", "diagnosis.json", "report.html"


@click.command(
    "diagnose",
    epilog="Example: hgma diagnose oven_test --calibration calibration.json --holdout another_oven_test -o diagnosis",
)
@options.bags_argument
@options.calibration
@click.option(
    "--holdout",
    metavar="BAG",
    type=RecordingPath(),
    help="Recording to judge on. Without it: the last of several, or the end of a single one.",
)
@options.output("DIR", "Folder for calibration.json, report.html and diagnosis.json; made if it is not there.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of the surrogates.")
@options.remap
@options.json_file
def command(
    bags: tuple[Path, ...],
    calibration: Path,
    holdout: Path | None,
    output: Path,
    seed: int,
    names: TopicNames,
    json_path: Path | None,
) -> None:
    """Name the physical effect that a calibration lacks, and add it.

    Looks at what the calibration leaves in the recordings. An effect is named only where noise could not have made
    it, where it predicts data that it was not fitted to, and where it lowers the error on the hold-out. The
    calibration written has the effects that do.
    """
    check_output_folder(output)
    return_memory()
    model = read_calibration(calibration)
    recordings, held = _read(bags, holdout, names)
    with progress_bar("diagnosing", STEPS * len(model.names)) as (bar, task):
        taken = dict.fromkeys(model.names, 0)

        def show(channel: str, text: str) -> None:
            taken[channel] = min(taken[channel] + 1, STEPS - 1)
            done = STEPS * model.names.index(channel) + taken[channel]
            bar.update(task, completed=done, description=f"{channel}: {text}")

        diagnosis = diagnose(recordings, model, held, seed=seed, progress=show)
    figures = _write(diagnosis, model, output, f"{', '.join(one.name for one in recordings)}, {model.sensor_id}")
    console.print(_table(diagnosis))
    for channel in diagnosis.channels:
        looks = " ".join(figures["channels"][channel.name].get("looks_like", ()))
        click.echo(f"{channel.name}: {sentence(channel)}{'. ' + looks if looks else ''}")
    click.echo(f"{output / REPORT}: report; {output / CALIBRATION}: calibration {diagnosis.calibration.calibration_id}")
    write_json(json_path, figures)


def sentence(channel: ChannelDiagnosis) -> str:
    """Return the verdict in words."""
    unit = unit_of(channel.name)
    change = f"error on the hold-out {quantity(channel.error_before, unit)} -> {quantity(channel.error_after, unit)}"
    if channel.effects:
        said = f"explained by {_list(channel.effects)}; {change}"
    elif channel.partial:
        said = f"unexplained: {_list(channel.partial)} carry a part, but {channel.judgement.reason}; {change}"
    else:
        said = f"{channel.verdict.value.replace('_', ' ')}: {channel.judgement.reason}"
    return "; ".join([said, *(_undecided(kinds()[name]) for name in channel.undecided)])


def _undecided(kind: type[Effect]) -> str:
    return f"{kind.name} fits as well and cannot be told apart here (that would take {kind.identified_by})"


def _list(effects: tuple[Any, ...]) -> str:
    return ", ".join(effect.name for effect in effects)


def _read(
    bags: tuple[Path, ...], holdout: Path | None, names: TopicNames
) -> tuple[list[FiledRecording], FiledRecording | None]:
    paths = [bag.resolve() for bag in (*bags, *([holdout] if holdout else []))]
    for number, path in enumerate(paths):
        if path in paths[:number]:
            raise RefusedError(f"{path.name} is given twice: a hold-out must be a recording that nothing is fitted to")
    with counting_bar("reading", declared_messages(paths, names)) as advance:
        recordings = [file_recording(bag, names, advance) for bag in bags]
        return recordings, file_recording(holdout, names, advance) if holdout else None


def _write(diagnosis: Diagnosis, original: Calibration, output: Path, title: str) -> dict[str, Any]:
    """Write the three files and return the figures."""
    from hgma_compensation.report.diagnosis_report import write_diagnosis_report  # brings matplotlib
    from hgma_compensation.report.remainder import looks_like

    figures = diagnosis.as_json(str(output / CALIBRATION))
    for channel in diagnosis.channels:
        if channel.verdict is Verdict.UNEXPLAINED:
            figures["channels"][channel.name]["looks_like"] = looks_like(channel)
    content = (json.dumps(figures, indent=1, allow_nan=False) + "\n").encode()
    with scratch_folder(output) as folder:
        write_diagnosis_report(diagnosis, folder / REPORT, title=title, original=original)
        write_calibration(diagnosis.calibration, folder / CALIBRATION)
        write_atomically(folder / FIGURES, content)
    return figures


def _table(diagnosis: Diagnosis) -> Table:
    errors = ("before", "after", "noise")
    title = f"RMS of means of 5 s on the hold-out {diagnosis.material.holdout}"
    table = new_table(title, ("channel", "verdict", *errors), numbers=errors)
    for channel in diagnosis.channels:
        unit = unit_of(channel.name)
        table.add_row(
            channel.name,
            channel.verdict.value,
            *(quantity(error, unit) for error in (channel.error_before, channel.error_after, channel.noise_floor)),
        )
    return table
