"""``hgma plan``."""

from pathlib import Path
from typing import Any

import click
from rich.table import Table
from rich.text import Text

from hgma_compensation.cli import options
from hgma_compensation.cli.terminal import check_folder, check_new, console, write_json
from hgma_compensation.coverage.effect_names import parse_effects
from hgma_compensation.effects.registry import kinds
from hgma_compensation.files import write_atomically
from hgma_compensation.programme import rules
from hgma_compensation.programme.plan import Programme, Wishes, plan
from hgma_compensation.programme.rules import Activity, demand_of
from hgma_compensation.programme.trial_run import EXAMPLES, scenario_text

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
    if json_path is not None:
        check_folder(json_path)
    if scenario is not None:
        check_new(scenario)
    effects = parse_effects(effects_text) or tuple(kinds())
    made = plan(Wishes(effects=effects, **wished))
    text = scenario_text(made, _simulated(simulated, effects_text, made), seed) if scenario is not None else ""
    console.print(steps_table(made))
    for line in remarks(made):
        click.echo(line)
    if scenario is not None:
        write_atomically(scenario, text.encode())
        click.echo(f"{scenario}: try it with hgma simulate {scenario} -o BAG")
    write_json(json_path, made.as_json())


def _simulated(text: str | None, effects_text: str, made: Programme) -> tuple[str, ...]:
    if text is not None:
        return parse_effects(text) or tuple(name for name in made.effects if name in EXAMPLES)
    chosen = click.get_current_context().get_parameter_source("effects_text")
    named = chosen is not click.core.ParameterSource.DEFAULT and effects_text.strip() != "all"
    return tuple(name for name in made.effects if name in EXAMPLES) if named else ()


def steps_table(made: Programme) -> Table:
    """Return the steps for the terminal."""
    table = Table(title=Text(f"Oven programme, {made.duration / 60.0:.1f} h, for {', '.join(made.effects)}"))
    for heading in ("step", "begins", "°C", "°C/min", "soak min", "min", "part", "what for"):
        table.add_column(heading, justify="left" if heading in ("part", "what for") else "right")
    for number, (start, step) in enumerate(zip(made.starts, made.steps, strict=True), start=1):
        table.add_row(
            str(number),
            f"{int(start // 60)}:{int(start % 60):02d}",
            f"{step.start:.4g} → {step.to:.4g}" if step.start != step.to else f"{step.to:.4g}",
            f"{step.rate:.3g}" if step.start != step.to else "-",
            f"{step.soak:.0f}",
            f"{step.duration:.0f}",
            step.part.value,
            Text(step.why),
        )
    return table


def remarks(made: Programme) -> list[str]:
    """Return what the table of steps cannot say."""
    said = [
        f"record at {rules.ACCELEROMETER_RATE:g} Hz or more, the thermistor at {rules.THERMISTOR_RATE:g} Hz or more, "
        f"better 10{'' if Activity.POWER in made.activities else ', power on all the time'}",
        f"hold-out: from {60.0 * made.hold_out:.0f} s on; learn with hgma train --until {60.0 * made.hold_out:.0f}",
    ]
    said += [f"{name}: {demand_of(name).why}" for name in made.effects]
    for activity in made.activities:
        times = [one.time for one in made.happenings if one.activity is activity]
        names = ", ".join(name for name in made.effects if demand_of(name).activity is activity)
        said.append(f"{names}: {activity.value}; {len(times)} times, first at {times[0]:.0f} s (all with --json)")
    said += [
        f"dropped: {one.name}, for which {one.hours:.1f} h more are needed than --hours {made.wishes.hours:g}"
        for one in made.dropped
    ]
    return [*said, *(f"note: {note}" for note in made.notes)]
