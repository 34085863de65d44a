"""What ``hgma export`` shows of the loss."""

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from hgma_compensation.channels import unit_of
from hgma_compensation.migration.export import Export
from hgma_compensation.migration.px4 import RENEWED_AFTER
from hgma_compensation.migration.recording_loss import RecordingLoss


def loss_table(export: Export) -> Table:
    """Return the loss at rest and over the calibrated rates, and what the autopilot's arithmetic adds."""
    table = Table(title="Loss of the cubic against the full model")
    for heading in ("channel", "unit", "", "RMS", "worst", "worst at"):
        table.add_column(heading, justify="right" if heading in ("RMS", "worst") else "left", no_wrap=True)
    rates = "over calibrated rates" + (", effects at rest" if export.calibration.effects else "")
    channels = {channel.name: channel for channel in export.calibration.channels}
    for fitted in export.cubics:
        channel, rest, ramp = channels[fitted.cubic.channel], fitted.at_rest, fitted.over_rates
        table.add_row(
            channel.name,
            unit_of(channel.name),
            "at rest",
            f"{rest.rms:.3g}",
            f"{rest.worst:.3g}",
            f"{rest.temperature:.3g} °C",
        )
        where = f"{ramp.temperature:.3g} °C, {ramp.rate:.2g} °C/s"
        table.add_row("", "", rates, f"{ramp.rms:.3g}", f"{ramp.worst:.3g}", where)
        if export.target.is_px4:
            step = fitted.steepest * float(RENEWED_AFTER)
            table.add_row("", "", "renewed after 1 °C", "", f"{step:.3g}", "")
        table.add_row("", "", "single precision", "", f"{export.rounding[channel.name]:.1g}", "")
        table.add_row("", "", "beside it: model's own error", f"{channel.error.unseen:.3g}", "", "", end_section=True)
    return table


def recording_table(losses: Sequence[RecordingLoss], title: str) -> Table:
    """Return the errors on a recording."""
    table = Table(title=Text(title))
    for heading in ("channel", "unit", "raw", "cubic", "full model", "noise of 5 s"):
        table.add_column(heading, justify="left" if heading in ("channel", "unit") else "right")
    for loss in losses:
        figures = (loss.raw, loss.cubic, loss.full, loss.noise_floor)
        table.add_row(loss.channel, unit_of(loss.channel), *(f"{figure:.4g}" for figure in figures))
    return table
