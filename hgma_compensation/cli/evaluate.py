"""``hgma evaluate``."""

from pathlib import Path

import click
from rich.table import Table

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.outputs import check_folder
from hgma_compensation.cli.progress_bars import counting_bar
from hgma_compensation.cli.recording_topics import declared_messages
from hgma_compensation.cli.report_option import report_option
from hgma_compensation.cli.tables import new_table, show_table
from hgma_compensation.evaluation.evaluate import MEAN_SECONDS, Evaluation
from hgma_compensation.evaluation.evaluate_bag import evaluate_bag
from hgma_compensation.quantities import quantity
from hgma_compensation.report.run_record import RunRecord
from hgma_compensation.topics import TopicNames
from hgma_compensation.training.reference import Reference

WHY_UNKNOWN = "the recording is too short for the Allan deviation"


@click.command("evaluate", epilog="Example: hgma evaluate another_oven_test --calibration calibration.json")
@options.bag_argument
@options.calibration
@options.reference
@click.option(
    "--plot", metavar="PNG", type=options.PathArgument(), help="Also draw error against time and temperature."
)
@report_option("Also write a page for people: error, Allan deviation, figures and what to do next.")
@options.time_range
@options.remap
@options.json_file
def command(
    bag: Path,
    calibration: Path,
    reference_text: str,
    plot: Path | None,
    report: Path | None,
    start: float | None,
    end: float | None,
    names: TopicNames,
    json_path: Path | None,
) -> None:
    """Print the error of a recording before and after compensation.

    Error and span are those of means over 5 s; random walk and bias instability are read off the Allan
    deviation.
    """
    if plot is not None:
        check_folder(plot)
    model = read_calibration(calibration)
    reference = Reference.parse(reference_text)
    record = RunRecord(len(model.names)) if report is not None else None
    observe = record.add if record is not None else None
    with counting_bar("compensating", declared_messages([bag], names)) as advance:
        evaluation = evaluate_bag(
            bag, model, reference, names=names, span=(start, end), progress=advance, observe=observe
        )
    show_table(table(evaluation, f"{bag.name}, reference {reference}"), WHY_UNKNOWN)
    if plot is not None:
        from hgma_compensation.evaluation.plots import (
            plot_evaluation,
        )  # matplotlib takes longer than the rest

        plot_evaluation(evaluation, plot, bag.name)
    if report is not None and record is not None:
        from hgma_compensation.report.evaluation_next import Evaluated
        from hgma_compensation.report.evaluation_report import write_evaluation_report

        about = Evaluated(bag, calibration, str(reference))
        write_evaluation_report(evaluation, record.summary(), model, about, report)
        click.echo(f"{report}: report")
    write_json(json_path, evaluation.as_json())


def table(evaluation: Evaluation, title: str) -> Table:
    """Return the evaluation for the terminal."""
    shown = new_table(title, ("channel", "", "raw", "compensated"), numbers=("raw", "compensated"))
    for channel in evaluation.channels:
        unit, raw, compensated = unit_of(channel.name), channel.raw, channel.compensated
        rows = (
            ("RMS error", raw.rms_error, compensated.rms_error, unit),
            ("span", raw.span, compensated.span, unit),
            ("random walk", raw.velocity_random_walk, compensated.velocity_random_walk, f"{unit}/√Hz"),
            ("bias instability", raw.bias_instability, compensated.bias_instability, unit),
        )
        for label, before, after, its_unit in rows:
            name = channel.name if label == "RMS error" else ""
            shown.add_row(name, label, quantity(before, its_unit), quantity(after, its_unit))
        shown.add_row("", f"noise of {MEAN_SECONDS:g} s", quantity(channel.noise_floor, unit), "")
        shown.add_section()
    return shown
