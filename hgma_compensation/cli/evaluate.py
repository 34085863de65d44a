"""``hgma evaluate``."""

from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.report_option import report_option
from hgma_compensation.cli.terminal import check_folder, console, counting_bar, write_json
from hgma_compensation.evaluation.evaluate import Evaluation
from hgma_compensation.evaluation.evaluate_bag import evaluate_bag
from hgma_compensation.report.run_record import RunRecord
from hgma_compensation.topics import TopicNames
from hgma_compensation.training.reference import Reference


@click.command("evaluate")
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
    with counting_bar("compensating") as advance:
        evaluation = evaluate_bag(
            bag, model, reference, names=names, span=(start, end), progress=advance, observe=observe
        )
    console.print(table(evaluation, f"{bag.name}, reference {reference}"))
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
    shown = Table(title=Text(title))  # a name may hold brackets, which are markup in a plain string
    for heading in (
        "channel",
        "unit",
        "",
        "RMS error",
        "span",
        "random walk /√Hz",
        "bias instability",
        "noise of 5 s",
    ):
        shown.add_column(heading, justify="left" if heading in ("channel", "unit", "") else "right")
    for channel in evaluation.channels:
        for label, measures in (("raw", channel.raw), ("compensated", channel.compensated)):
            first = label == "raw"
            shown.add_row(
                channel.name if first else "",
                unit_of(channel.name) if first else "",
                label,
                f"{measures.rms_error:.4g}",
                f"{measures.span:.4g}",
                _number(measures.velocity_random_walk),
                _number(measures.bias_instability),
                f"{channel.noise_floor:.4g}" if first else "",
            )
    return shown


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
