"""Tables of the commands: within 80 columns, names as they are, what is not known explained."""

import io

from rich.console import Console

from hgma_compensation.cli import fleet
from hgma_compensation.cli.check import limits_table
from hgma_compensation.cli.plan import steps_table
from hgma_compensation.coverage.result import ChannelCheck, EffectCheck, Level
from hgma_compensation.effects.registry import kinds
from hgma_compensation.fleet.figures import FIGURES
from hgma_compensation.fleet.limits import Limits
from hgma_compensation.fleet.options import FleetOptions
from hgma_compensation.fleet.status import Judged, Status
from hgma_compensation.fleet.summary import summarise
from hgma_compensation.programme.plan import plan
from hgma_compensation.programme.programme import Wishes
from hgma_compensation.training.train import TrainingOptions

Z = "linear_acceleration.z"
JUDGED = Judged("sha256-0123456789abcdef", ("train",), "holdout", None, "9.81")


def drawn(table, width=80):
    """Return the lines of a table on a terminal that is so wide; one that does not fit is cut at its right."""
    console = Console(width=width, record=True, file=io.StringIO())
    console.print(table)
    return console.export_text().splitlines()


def test_a_fleet_names_folders_as_they_are_and_fits_six_figures_into_a_line():
    figures = {figure.name: -1234.5678 for figure in FIGURES}
    unknown = {**figures, "r_squared": None}
    statuses = [Status("[red]s1", JUDGED, channels={Z: figures}), Status("s2", JUDGED, channels={Z: unknown})]
    rows = drawn(fleet._table(summarise(statuses, Limits(), FleetOptions(TrainingOptions())), Z))
    (first,) = [row for row in rows if "[red]s1" in row]
    assert first.split() == ["[red]s1", "calibrated", *["-1235"] * 5, "-1234.57"]
    assert [row.split()[-1] for row in rows if "s2" in row] == ["-"]
    assert any("m/s²/√Hz" in row for row in rows)


def test_every_effect_fits_into_a_plan_and_into_what_is_missing():
    made = plan(Wishes(effects=tuple(kinds())))
    rows = drawn(steps_table(made))
    assert len([row for row in rows if row[:6].strip().isdigit()]) == len(made.steps)
    assert all(step.why.split()[-1] in "".join(rows) for step in made.steps)
    checks = tuple(EffectCheck(name, Level.NOT, "no reason", "record it") for name in kinds())
    text = "\n".join(drawn(limits_table(ChannelCheck(Z, 1.0, 1.0, 1.0, 4, checks, ()))))
    assert all(name in text for name in kinds())
