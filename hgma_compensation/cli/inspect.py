"""``hgma inspect``."""

from pathlib import Path

import click
from rich.table import Table

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration
from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.calibration.encoding import encode
from hgma_compensation.channels import unit_of
from hgma_compensation.cli import options, paths
from hgma_compensation.cli.terminal import console, write_json
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.effects.applied import AppliedEffect
from hgma_compensation.kalman.design import settled_filter
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.temperature.features import NAMES, UNITS, Product


@click.command("inspect")
@click.argument("calibration", metavar="CAL", type=paths.CalibrationPath())
@options.json_file
def command(calibration: Path, json_path: Path | None) -> None:
    """Say in words what a calibration holds."""
    model = read_calibration(calibration)
    training, features = model.training, model.features
    click.echo(f"Calibration {model.calibration_id} of sensor {model.sensor_id}, made by {training['tool']}")
    recordings = ", ".join(
        f"{r['name']} ({r['duration'] / 60.0:.0f} min, {r['samples']} samples)" for r in training["recordings"]
    )
    click.echo(f"Trained by {training['method']}, seed {training['seed']}, on {recordings}")
    validation = f"; validated on {training['folds']}" if "folds" in training else ""
    click.echo(f"Reference {training['reference']}; fitted to means of {training['block']:g} s{validation}")
    click.echo(
        f"Thermistor noise {features.noise.measurement**0.5:.4f} °C; a thermistor sample is used for accelerations "
        f"{features.latency * 1e3:g} ms later; its trend is held after {features.prediction_horizon:g} s of silence"
    )
    if features.product is Product.DELAY:
        click.echo(f"Inputs T, Ṫ and T·ΔT with ΔT over {features.delay:g} s")
    else:
        click.echo(f"Inputs T, Ṫ and T·ΔT with ΔT to {features.reference_temperature:g} °C")
    console.print(_range(model))
    console.print(_channels(model))
    for applied in model.effects:
        click.echo(_in_words(applied))
    write_json(json_path, {"calibration_id": model.calibration_id, **encode(model)})


def _in_words(applied: AppliedEffect) -> str:
    """Return an effect with its parameters and gains, in one line."""
    effect = applied.effect
    units = {name: span.unit for name, span in effect.spans.items()}
    parameters = [f"{name} {_quantity(value, units.get(name, ''))}" for name, value in effect.parameters().items()]
    gains = ", ".join(f"{gain:.4g}" for gain in applied.gains.tolist())
    return (
        f"{applied.channel}: {effect.title} ({', '.join([effect.name, *parameters])}); "
        f"gains {gains} {unit_of(applied.channel)}{effect.gain_unit}"
    )


def _quantity(value: float | str, unit: str) -> str:
    return value if isinstance(value, str) else f"{value:.6g} {unit}".rstrip()


def _range(model: Calibration) -> Table:
    table = Table(title="Calibrated range")
    for heading in ("input", "unit", "from", "to"):
        table.add_column(heading, justify="left" if heading in ("input", "unit") else "right")
    box = model.calibrated_range
    for name, unit, low, high in zip(NAMES, UNITS, box.lower, box.upper, strict=True):
        table.add_row(name, unit, f"{low:.4g}", f"{high:.4g}")
    return table


def _channels(model: Calibration) -> Table:
    table = Table(title=f"Channels; RMS over means of {model.training['block']:g} s")
    for heading in ("channel", "unit", "reference", "model", "filter", "fitted", "cross-validated", "noise"):
        table.add_column(heading)
    recording = model.training["recordings"][0]
    interval = recording["duration"] / recording["samples"]
    for channel in model.channels:
        error = channel.error
        table.add_row(
            channel.name,
            unit_of(channel.name),
            f"{channel.reference:.5g}",
            _model(channel),
            _filter(channel, interval),
            f"{error.fit:.4g}",
            "-" if error.cross_validated is None else f"{error.cross_validated:.4g}",
            f"{error.noise:.4g}",
        )
    return table


def _model(channel: ChannelCalibration) -> str:
    if isinstance(channel.drift, RadialBasisDrift):
        return f"{len(channel.drift.weights)} Gaussians + linear"
    return "polynomial"


def _filter(channel: ChannelCalibration, interval: float) -> str:
    noise = channel.filter.noise
    if noise is None or interval <= 0.0:
        return channel.filter.mode.value
    settled = settled_filter(noise, interval)
    shown = f"{channel.filter.mode.value}, {settled.time_constant:.3g} s"
    if channel.filter.mode is FilterMode.BIAS:
        return shown
    return f"{shown}, white noise / {settled.noise_reduction:.3g}"
