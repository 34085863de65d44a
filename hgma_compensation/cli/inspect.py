"""``hgma inspect``."""

from pathlib import Path
from typing import Any

import click
from rich.table import Table

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration
from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.calibration.encoding import encode
from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options, paths
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.provenance import diagnosed, trained
from hgma_compensation.cli.tables import new_table, show_table
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.kalman.design import SettledFilter, settled_filter
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.quantities import chosen, duration, number, quantity, shown_unit
from hgma_compensation.temperature.features import NAMES, UNITS, Product

WHY_UNKNOWN = "the training had no cross-validation, or a diagnosis has fitted the channel again"


@click.command("inspect", epilog="Example: hgma inspect calibration.json")
@click.argument("calibration", metavar="CAL", type=paths.CalibrationPath())
@options.json_file
def command(calibration: Path, json_path: Path | None) -> None:
    """Say in words what a calibration holds."""
    model = read_calibration(calibration)
    features = model.features
    click.echo(f"Calibration {model.calibration_id} of sensor {model.sensor_id}, made by {model.training['tool']}")
    for sentence in (*trained(model), *diagnosed(model)):
        click.echo(sentence)
    click.echo(
        f"Thermistor noise {quantity(features.noise.measurement**0.5, '°C')}; a thermistor sample is used for "
        f"accelerations {duration(features.latency)} later; its trend is held after "
        f"{duration(features.prediction_horizon)} of silence"
    )
    if features.product is Product.DELAY:
        click.echo(f"Inputs T, Ṫ and T·ΔT with ΔT over {duration(features.delay)}")
    else:
        click.echo(f"Inputs T, Ṫ and T·ΔT with ΔT to {chosen(features.reference_temperature, '°C')}")
    show_table(_range(model), WHY_UNKNOWN)
    show_table(_channels(model), WHY_UNKNOWN)
    for applied in model.effects:
        click.echo(_in_words(applied))
    write_json(json_path, {"calibration_id": model.calibration_id, **encode(model), "settled_filters": _settled(model)})


def _in_words(applied: AppliedEffect) -> str:
    """Return an effect with its parameters and gains, in one line."""
    effect = applied.effect
    units = {name: span.unit for name, span in effect.spans.items()}
    parameters = [f"{name} {_parameter(value, units.get(name, ''))}" for name, value in effect.parameters().items()]
    gains = ", ".join(number(gain) for gain in applied.gains.tolist())
    return (
        f"{applied.channel}: {effect.title} ({', '.join([effect.name, *parameters])}); "
        f"gains {gains} {shown_unit(unit_of(applied.channel) + effect.gain_unit)}"
    )


def _parameter(value: float | str, unit: str) -> str:
    return value if isinstance(value, str) else chosen(value, unit)


def _range(model: Calibration) -> Table:
    table = new_table("Calibrated range", ("input", "from", "to"), numbers=("from", "to"))
    box = model.calibrated_range
    for name, unit, low, high in zip(NAMES, UNITS, box.lower, box.upper, strict=True):
        table.add_row(name, quantity(low, unit), quantity(high, unit))
    return table


def _channels(model: Calibration) -> Table:
    title = f"Channels; errors are RMS over means of {duration(model.training['block'])}"
    table = new_table(title, ("channel", "", "value"))
    for channel in model.channels:
        error, unit = channel.error, unit_of(channel.name)
        rows = (
            ("reference", quantity(channel.reference, unit, digits=6)),
            ("model", _model(channel)),
            ("filter", _filter(model, channel)),
            ("error, fitted", quantity(error.fit, unit)),
            ("error, cross-validated", quantity(error.cross_validated, unit)),
            ("noise of such a mean", quantity(error.noise, unit)),
        )
        for label, value in rows:
            table.add_row(channel.name if label == "reference" else "", label, value)
        table.add_section()
    return table


def _model(channel: ChannelCalibration) -> str:
    if isinstance(channel.drift, RadialBasisDrift):
        return f"{len(channel.drift.weights)} Gaussians + linear"
    return "polynomial"


def _filter(model: Calibration, channel: ChannelCalibration) -> str:
    settled = _settled_filter(model, channel)
    if settled is None:
        return channel.filter.mode.value
    shown = f"{channel.filter.mode.value}, {duration(settled.time_constant)}"
    if channel.filter.mode is FilterMode.BIAS:
        return shown
    return f"{shown}, white noise / {settled.noise_reduction:.3g}"


def _settled_filter(model: Calibration, channel: ChannelCalibration) -> SettledFilter | None:
    """Return how the channel's filter ends up at the sample rate of the training, None where it is off."""
    recording = model.training["recordings"][0]
    interval = recording["duration"] / recording["samples"]
    noise = channel.filter.noise
    return None if noise is None or interval <= 0.0 else settled_filter(noise, interval)


def _settled(model: Calibration) -> dict[str, Any]:
    """Return time constant (s) and noise reduction of each channel that has a filter."""
    found = {channel.name: _settled_filter(model, channel) for channel in model.channels}
    return {
        name: {"time_constant": settled.time_constant, "noise_reduction": settled.noise_reduction}
        for name, settled in found.items()
        if settled is not None
    }
