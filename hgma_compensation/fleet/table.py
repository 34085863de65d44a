"""The summary as a table for spreadsheets: a row for each channel of each sensor."""

import csv
import io

from hgma_compensation.channels import unit_of
from hgma_compensation.fleet.figures import FIGURES
from hgma_compensation.fleet.summary import Summary, Unit

COLUMNS = (
    "sensor",
    "state",
    "channel",
    "unit",
    *(figure.name for figure in FIGURES),
    "broken",
    "outlying",
    "calibration_id",
    "judged_on",
    "reason",
)


def summary_csv(summary: Summary) -> str:
    """Return the table; a sensor that could not be calibrated has one row, with the reason."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    for unit in summary.units:
        for channel in unit.status.channels or [""]:
            rows.writerow(_row(unit, channel))
    return text.getvalue()


def _row(unit: Unit, channel: str) -> list[str]:
    status, judged = unit.status, unit.status.judged
    figures = status.channels.get(channel, {})
    values = [figures.get(figure.name) for figure in FIGURES]
    return [
        status.sensor,
        unit.state.value,
        channel,
        unit_of(channel) if channel else "",
        *("" if value is None else repr(value) for value in values),
        " ".join(one.figure for one in unit.broken if one.channel == channel),
        " ".join(one.figure for one in unit.outliers if one.channel == channel),
        "" if judged is None else judged.calibration_id,
        "" if judged is None else judged.judged_on,
        status.reason,
    ]
