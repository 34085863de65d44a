"""``hgma import-csv``."""

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from hgma_compensation.channels import CHANNELS
from hgma_compensation.cli import options, paths
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.outputs import check_new
from hgma_compensation.cli.progress_bars import counting_bar
from hgma_compensation.errors import RefusedError
from hgma_compensation.migration.presets import PRESETS
from hgma_compensation.quantities import count, duration
from hgma_compensation.recording.bag_writer import Storage, write_recording
from hgma_compensation.recording.csv_table import (
    ACCELERATION_UNITS,
    RATE_UNITS,
    TEMPERATURE_UNITS,
    TIME_UNITS,
    Columns,
    read_table,
)


def _channel_options(function: Any) -> Any:
    for channel in reversed(CHANNELS):
        flag = "--" + channel.replace("_", "-").replace(".", "-")
        function = click.option(flag, channel.replace(".", "__"), metavar="COL", help=f"Column of {channel}.")(function)
    return function


def _unit(flag: str, units: Any, default: str) -> Any:
    return click.option(
        flag, type=click.Choice(list(units)), default=default, show_default=True, help="Unit in the table."
    )


EXAMPLE = "Example: hgma import-csv table.csv -o oven_test --time t --temperature T --linear-acceleration-z az"


def _epilog() -> str:
    lines = "\n".join(f"{name}: {preset.made_by}" for name, preset in PRESETS.items())
    return f"\b\nPresets, and what makes their tables:\n{lines}\n\n{EXAMPLE}"


@click.command("import-csv", epilog=_epilog())
@click.argument("file", type=paths.TablePath())
@options.output("BAG", "Recording to write.")
@click.option(
    "--preset",
    type=click.Choice(list(PRESETS)),
    help="Columns and units of an autopilot's log; what else is given wins.",
)
@click.option(
    "--sensor",
    type=click.IntRange(min=0),
    default=0,
    metavar="N",
    help="With a preset whose table mixes sensors: which.",
)
@click.option("--time", metavar="COL", help="Column of the time.")
@click.option("--temperature", metavar="COL", help="Column of the thermistor.")
@_channel_options
@click.option("--temperature-2", metavar="COL", help="Column of a second thermometer.")
@click.option("--supply-voltage", metavar="COL", help="Column of the supply voltage, V.")
@_unit("--time-unit", TIME_UNITS, "s")
@_unit("--acceleration-unit", ACCELERATION_UNITS, "m/s^2")
@_unit("--angular-velocity-unit", RATE_UNITS, "rad/s")
@_unit("--temperature-unit", TEMPERATURE_UNITS, "C")
@click.option("--from", "start", type=float, metavar="S", help="Only rows whose time is S seconds or more.")
@click.option("--until", "end", type=float, metavar="S", help="Only rows whose time is below S seconds.")
@click.option(
    "--skip-rows", type=click.IntRange(min=0), default=0, metavar="N", help="Leave out the first N data rows."
)
@click.option("--frame-id", default="imu_link", show_default=True, help="Frame of the messages.")
@options.storage
@options.json_file
def command(file: Path, output: Path, storage: Storage, json_path: Path | None, **chosen: Any) -> None:
    """Make a recording out of a table with a header line.

    A column (COL) is given by its name or by its number, counted from 1. Time keeps the table's scale.
    """
    check_new(output)
    only = _apply_preset(chosen)
    columns = Columns(
        time=chosen["time"],
        temperature=chosen["temperature"],
        channels={c: chosen[c.replace(".", "__")] for c in CHANNELS if chosen[c.replace(".", "__")] is not None},
        temperature_2=chosen["temperature_2"],
        supply_voltage=chosen["supply_voltage"],
        time_unit=chosen["time_unit"],
        acceleration_unit=chosen["acceleration_unit"],
        rate_unit=chosen["angular_velocity_unit"],
        temperature_unit=chosen["temperature_unit"],
        start=chosen["start"],
        end=chosen["end"],
        skip_rows=chosen["skip_rows"],
        only=only,
        frame=chosen["frame_id"],
    )
    with counting_bar("reading", file.stat().st_size) as advance:
        recording = read_table(file, columns, advance)
    with counting_bar("writing", 2.0 * len(recording.stamps)) as advance:
        write_recording(recording, output, storage, advance)
    click.echo(
        f"{output}: {count(len(recording.stamps))} samples over {duration(recording.duration)} "
        f"of {', '.join(recording.present)}"
    )
    write_json(
        json_path,
        {
            "samples": len(recording.stamps),
            "duration": recording.duration,
            "channels": list(recording.present),
        },
    )


def _apply_preset(chosen: dict[str, Any]) -> tuple[str, float] | None:
    """Fill in what the preset says and the command line does not; return the column and number of the sensor's rows."""
    context = click.get_current_context()
    preset = None if chosen["preset"] is None else PRESETS[chosen["preset"]]
    if preset is not None:
        settings = {
            "time": preset.time,
            "temperature": preset.temperature,
            "time_unit": preset.time_unit,
            "acceleration_unit": preset.acceleration_unit,
            "angular_velocity_unit": preset.rate_unit,
            "temperature_unit": preset.temperature_unit,
            **{channel.replace(".", "__"): column for channel, column in preset.channels.items()},
        }
        for name, value in settings.items():
            if context.get_parameter_source(name) is not ParameterSource.COMMANDLINE:
                chosen[name] = value
    for name in ("time", "temperature"):
        if chosen[name] is None:
            raise RefusedError(f"--{name} is missing: name the column, or give --preset {'|'.join(PRESETS)}")
    if preset is not None and preset.sensor is not None:
        return preset.sensor, float(chosen["sensor"])
    if context.get_parameter_source("sensor") is ParameterSource.COMMANDLINE:
        raise RefusedError("--sensor is for a preset whose table mixes sensors: each has a file of its own here")
    return None
