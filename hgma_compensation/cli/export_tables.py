"""What ``hgma export`` shows of the loss."""

from collections.abc import Sequence

from rich.table import Table

from hgma_compensation.channels import unit_of
from hgma_compensation.cli.tables import new_table
from hgma_compensation.migration.export import Export
from hgma_compensation.migration.px4 import RENEWED_AFTER
from hgma_compensation.migration.recording_loss import RecordingLoss
from hgma_compensation.quantities import number, quantity, shown_unit

DIGITS = 3
"""Of a loss."""


def loss_table(export: Export) -> Table:
    """Return the loss at rest and over the calibrated rates, and what the autopilot's arithmetic adds."""
    figures = ("RMS", "worst")
    table = new_table("Loss of the cubic against the full model", ("channel", *figures, "worst at"), numbers=figures)
    rates = "over rates, effects at rest" if export.calibration.effects else "over calibrated rates"
    channels = {channel.name: channel for channel in export.calibration.channels}
    for fitted in export.cubics:
        channel, rest, ramp = channels[fitted.cubic.channel], fitted.at_rest, fitted.over_rates
        unit = unit_of(channel.name)

        def loss(value: float, its_unit: str = unit, digits: int = DIGITS) -> str:
            return quantity(value, its_unit, digits)

        at_rest = quantity(rest.temperature, "°C", DIGITS)
        table.add_row(channel.name)
        table.add_row("  at rest", loss(rest.rms), loss(rest.worst), at_rest)
        where = f"{quantity(ramp.temperature, '°C', DIGITS)}, {quantity(ramp.rate, '°C/s', 2)}"
        table.add_row(f"  {rates}", loss(ramp.rms), loss(ramp.worst), where)
        if export.target.is_px4:
            table.add_row("  renewed after 1 °C", "", loss(fitted.steepest * float(RENEWED_AFTER)), "")
        table.add_row("  single precision", "", loss(export.rounding[channel.name], digits=1), "")
        table.add_row("  model's own error", loss(channel.error.unseen), "", "", end_section=True)
    return table


def recording_table(losses: Sequence[RecordingLoss], title: str) -> Table:
    """Return the errors on a recording."""
    figures = ("raw", "cubic", "full model", "noise of 5 s")
    table = new_table(title, ("channel", "unit", *figures), numbers=figures)
    for loss in losses:
        errors = (loss.raw, loss.cubic, loss.full, loss.noise_floor)
        table.add_row(loss.channel, shown_unit(unit_of(loss.channel)), *(number(error) for error in errors))
    return table
