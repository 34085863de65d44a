"""``hgma export``."""

from pathlib import Path

import click
from click.core import ParameterSource

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.channels import parse_channels, unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.export_tables import loss_table, recording_table
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.outputs import check_new
from hgma_compensation.cli.paths import CalibrationPath, ChannelList, RecordingPath
from hgma_compensation.cli.progress_bars import counting_bar
from hgma_compensation.cli.tables import console
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically
from hgma_compensation.migration.export import Export, make_export
from hgma_compensation.migration.parameters import AxisConvention
from hgma_compensation.migration.recording_loss import RecordingLoss, loss_on
from hgma_compensation.migration.target import Format, Target
from hgma_compensation.quantities import counted, quantity
from hgma_compensation.topics import TopicNames
from hgma_compensation.training.reference import Reference

OF_RECORDING = {"reference_text": "--reference", "start": "--from", "end": "--until", "names": "--remap"}


@click.command("export", epilog="Example: hgma export calibration.json --format px4 -o imu.params")
@click.argument("calibration", metavar="CAL", type=CalibrationPath())
@click.option(
    "--format",
    "format_name",
    required=True,
    type=click.Choice([kind.value for kind in Format]),
    help="px4: file for QGroundControl; px4-nsh: the same as commands; ardupilot: file for its ground stations.",
)
@options.output("FILE", "File of parameters to write.")
@click.option(
    "--instance",
    type=int,
    default=0,
    show_default=True,
    metavar="N",
    help="Which of the autopilot's sensors, counted from 0: TC_A0, INS_TCAL1.",
)
@click.option("--device-id", type=int, metavar="ID", help="PX4: device_id of the accelerometer, for TC_A0_ID.")
@click.option("--gyro-device-id", type=int, metavar="ID", help="PX4: device_id of the gyroscope, for TC_G0_ID.")
@click.option(
    "--axes",
    type=click.Choice([kind.value for kind in AxisConvention]),
    default=AxisConvention.SAME.value,
    show_default=True,
    help="Axes of the calibration: same as the autopilot's sensor topic, or flu (forward, left, up) of a ROS driver.",
)
@click.option(
    "--channels",
    "channels_text",
    metavar="LIST",
    type=ChannelList(),
    help="Comma-separated. Channels to export; all of the calibration if not given.",
)
@click.option(
    "--range",
    "span",
    type=float,
    nargs=2,
    default=None,
    metavar="FROM TO",
    help="Only these temperatures, °C; all that are calibrated if not given.",
)
@click.option("--recording", "bag", type=RecordingPath(), metavar="BAG", help="Also state the loss on a recording.")
@options.reference
@click.option("--from", "start", type=float, metavar="S", help="Count samples from S seconds on; the rest is history.")
@click.option("--until", "end", type=float, metavar="S", help="Count samples before S seconds from the start.")
@options.remap
@options.json_file
def command(
    calibration: Path,
    format_name: str,
    output: Path,
    instance: int,
    device_id: int | None,
    gyro_device_id: int | None,
    axes: str,
    channels_text: str | None,
    span: tuple[float, float] | None,
    bag: Path | None,
    reference_text: str,
    start: float | None,
    end: float | None,
    names: TopicNames,
    json_path: Path | None,
) -> None:
    """Write the cubic that an autopilot takes, and say what it loses against the full model.

    --reference, --from, --until and --remap are for --recording. Read docs/MIGRATION.md before flying with it.
    """
    _check_options(bag)
    check_new(output)
    ids = {"linear_acceleration": device_id, "angular_velocity": gyro_device_id}
    target = Target(
        format=Format(format_name),
        instance=instance,
        axes=AxisConvention(axes),
        device_ids={group: number for group, number in ids.items() if number is not None},
        span=span,
        channels=None if channels_text is None else parse_channels(channels_text),
    )
    reference = Reference.parse(reference_text)
    export = make_export(read_calibration(calibration), target)
    losses: tuple[RecordingLoss, ...] = ()
    if bag is not None:
        with counting_bar("compensating") as advance:
            all_losses = loss_on(
                bag,
                export.calibration,
                export.offsets(),
                reference,
                names=names,
                span=(start, end),
                progress=advance,
            )
        exported = {f.cubic.channel for f in export.cubics}
        losses = tuple(loss for loss in all_losses if loss.channel in exported)
    write_atomically(output, export.text().encode())
    _show(export, output)
    if bag is not None:
        console.print(recording_table(losses, f"RMS error on {bag.name}, means of 5 s, reference {reference}"))
    write_json(json_path, export.as_json(losses))


def _check_options(bag: Path | None) -> None:
    """Raise RefusedError for an option that says nothing without a recording."""
    context = click.get_current_context()
    for name, flag in OF_RECORDING.items():
        if bag is None and context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            raise RefusedError(f"{flag} is for the loss on a recording: give the bag with --recording, or leave it out")


def _show(export: Export, output: Path) -> None:
    span = export.span
    click.echo(
        f"{output}: {counted(len(export.parameters), 'parameter')} for {quantity(span.lowest, '°C')} to "
        f"{quantity(span.highest, '°C')} about {quantity(span.reference, '°C')}, of {export.calibration.calibration_id}"
    )
    console.print(loss_table(export))
    if not export.target.is_px4:
        constants = ", ".join(
            f"{f.cubic.channel} {quantity(f.cubic.coefficients[0], unit_of(f.cubic.channel))}" for f in export.cubics
        )
        click.echo(
            f"left to the accelerometer's calibration on the vehicle, to be done once these are loaded: {constants}, "
            "the constant terms"
        )
    for line in export.not_carried:
        click.echo(f"not carried: {line}")
    for line in export.warnings:
        click.echo(f"warning: {line}", err=True)
