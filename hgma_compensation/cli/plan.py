"""``hgma plan``."""

from pathlib import Path
from typing import Any

import click
from rich.table import Table

from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.outputs import check_new
from hgma_compensation.cli.tables import new_table, show_table
from hgma_compensation.coverage.effect_names import parse_effects
from hgma_compensation.effects.registry import kinds
from hgma_compensation.files import write_atomically
from hgma_compensation.programme import rules
from hgma_compensation.programme.plan import plan
from hgma_compensation.programme.programme import Programme, Wishes
from hgma_compensation.programme.rules import Activity, demand_of
from hgma_compensation.programme.trial_run import EXAMPLES, scenario_text
from hgma_compensation.quantities import UNKNOWN, chosen, counted, duration, setting

WHY_UNKNOWN = "the temperature is kept"
DEFAULTS = Wishes()
CELSIUS, RATE = click.FloatRange(-100.0, 250.0), click.FloatRange(0.01, 1000.0)


@click.command("plan", epilog="Example: hgma plan --effects thermal_lag,hysteresis --ramp-rate 2 --hours 8")
@click.option(
    "--effects",
    "effects_text",
    metavar="NAME,...|all",
    default=",".join(rules.OVEN_ALONE),
    show_default=True,
    help="Effects that the programme is to set off.",
)
@click.option("--from", "lowest", type=CELSIUS, default=DEFAULTS.lowest, show_default=True, help="°C.")
@click.option("--to", "highest", type=CELSIUS, default=DEFAULTS.highest, show_default=True, help="°C.")
@click.option(
    "--ramp-rate", type=RATE, default=DEFAULTS.ramp_rate, show_default=True, help="What the oven can do, °C/min."
)
@click.option(
    "--mission-rate",
    type=RATE,
    default=DEFAULTS.mission_rate,
    show_default=True,
    help="The fastest change that the robot sees, °C/min.",
)
@click.option(
    "--time-constant",
    type=click.FloatRange(0.0, 2e5, min_open=True),
    metavar="S",
    help="Of the memories looked for, where it is known. Default: 180 s for a lag, an hour for creep.",
)
@click.option(
    "--hours",
    type=click.FloatRange(0.0, min_open=True),
    metavar="H",
    help="Time available; effects that it is too short for are dropped, and named.",
)
@click.option("--scenario", metavar="YAML", type=options.PathArgument(), help="Also write it for hgma simulate.")
@click.option(
    "--simulated",
    metavar="NAME,...",
    help="Effects that the sensor of the scenario has. Default: those that --effects names, none for all.",
)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Of the scenario.")
@options.json_file
def command(
    effects_text: str,
    scenario: Path | None,
    simulated: str | None,
    seed: int,
    json_path: Path | None,
    **wished: Any,
) -> None:
    """Print an oven programme that sets off the effects wanted, and what else they need.

    Rates, soaks and what is repeated follow from the effects; the last cycle, at a rate of its own, is to be kept out
    of the training. With --scenario the programme can be tried on a simulated sensor before the oven is booked.
    """
    if scenario is not None:
        check_new(scenario)
    effects = parse_effects(effects_text) or tuple(kinds())
    made = plan(Wishes(effects=effects, **wished))
    text = scenario_text(made, _simulated(simulated, effects_text, made), seed) if scenario is not None else ""
    show_table(steps_table(made), WHY_UNKNOWN)
    for line in remarks(made):
        click.echo(line)
    if scenario is not None:
        write_atomically(scenario, text.encode())
        click.echo(f"{scenario}: try it with hgma simulate {scenario} -o BAG")
    write_json(json_path, made.as_json())


def _simulated(text: str | None, effects_text: str, made: Programme) -> tuple[str, ...]:
    if text is not None:
        return parse_effects(text) or tuple(name for name in made.effects if name in EXAMPLES)
    source = click.get_current_context().get_parameter_source("effects_text")
    named = source is not click.core.ParameterSource.DEFAULT and effects_text.strip() != "all"
    return tuple(name for name in made.effects if name in EXAMPLES) if named else ()


def steps_table(made: Programme) -> Table:
    """Return the steps for the terminal; when they begin as hours and minutes."""
    numbers = ("step", "h:min", "°C", "°C/min", "soak", "lasts")
    title = f"Oven programme, {_minutes(made.duration)}, for {', '.join(made.effects)}"
    table = new_table(title, (*numbers, "what for"), numbers=numbers)
    for place, (start, step) in enumerate(zip(made.starts, made.steps, strict=True), start=1):
        begins = round(start)
        moves = step.start != step.to
        table.add_row(
            str(place),
            f"{begins // 60}:{begins % 60:02d}",
            f"{setting(step.start)} → {setting(step.to)}" if moves else setting(step.to),
            setting(step.rate) if moves else UNKNOWN,
            _minutes(step.soak),
            _minutes(step.duration),
            step.why,
        )
    return table


def _minutes(length: float) -> str:
    """Return a length in min, to whole ones: nobody programmes an oven to the second."""
    return duration(60.0 * round(length))


def remarks(made: Programme) -> list[str]:
    """Return what the table of steps cannot say."""
    said = [
        f"record at {chosen(rules.ACCELEROMETER_RATE, 'Hz')} or more, the thermistor at "
        f"{chosen(rules.THERMISTOR_RATE, 'Hz')} or more, better {chosen(10.0, 'Hz')}"
        f"{'' if Activity.POWER in made.activities else ', power on all the time'}",
        f"hold-out: from {_minutes(made.hold_out)} on; learn with hgma train --until {60.0 * made.hold_out:.0f}",
    ]
    said += [f"{name}: {demand_of(name).why}" for name in made.effects]
    for activity in made.activities:
        times = [one.time for one in made.happenings if one.activity is activity]
        names = ", ".join(name for name in made.effects if demand_of(name).activity is activity)
        first = f"{counted(len(times), 'time')}, first after {duration(times[0])} (all with --json)"
        said.append(f"{names}: {activity.value}; {first}")
    said += [
        f"dropped: {one.name}, for which {duration(3600.0 * one.hours)} more are needed than --hours "
        f"{setting(made.wishes.hours or 0.0)}"
        for one in made.dropped
    ]
    return [*said, *(f"note: {note}" for note in made.notes)]
