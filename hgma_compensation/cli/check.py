"""``hgma check``."""

from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.channels import parse_channels, unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.paths import CalibrationPath, ChannelList, RecordingPath
from hgma_compensation.cli.progress_bars import counting_bar, progress_bar
from hgma_compensation.cli.tables import console, new_table, show_table
from hgma_compensation.coverage.check import check
from hgma_compensation.coverage.effect_names import parse_effects
from hgma_compensation.coverage.reading import read
from hgma_compensation.coverage.result import ChannelCheck, Check, EffectCheck, Level, RecordingFacts
from hgma_compensation.errors import RefusedError
from hgma_compensation.quantities import UNKNOWN, count, counted, duration, number, quantity, shown_unit
from hgma_compensation.topics import TopicNames

DIGITS = 3
"""Of sizes and parameters, which are tried in steps of some per cent."""

FROM = "shows\nfrom"
WHY_UNKNOWN = "it would not be named whatever its size, or has no such parameter or likeness"
COLOURS = {Level.IDENTIFIABLE: "green", Level.WEAKLY: "yellow", Level.NOT: "red"}


@click.command("check", epilog="Example: hgma check oven_test")
@options.bags_argument
@click.option(
    "--effects", "effects_text", metavar="NAME,...|all", default="all", show_default=True, help="Effects to judge."
)
@click.option(
    "--calibration",
    metavar="CAL",
    type=CalibrationPath(),
    help="Calibration that a diagnosis is to start from. Default: a cubic with rate terms, fitted here.",
)
@click.option(
    "--holdout",
    metavar="BAG",
    type=RecordingPath(),
    help="Recording that nothing is learned from, as for hgma diagnose. Without it: the last of several, or the last "
    "quarter of a single one.",
)
@click.option(
    "--channels",
    metavar="LIST",
    type=ChannelList(),
    help="Comma-separated. Default: those of the calibration, or all there are.",
)
@options.time_range
@options.remap
@options.json_file
def command(
    bags: tuple[Path, ...],
    effects_text: str,
    calibration: Path | None,
    holdout: Path | None,
    channels: str | None,
    start: float | None,
    end: float | None,
    names: TopicNames,
    json_path: Path | None,
) -> None:
    """Say what recordings can and cannot identify, before anything is fitted to them.

    For each effect: the smallest size that hgma diagnose would name in what it would learn from, computed with the
    recording's own noise, and what to record where that is not small.
    """
    effects = parse_effects(effects_text)
    wanted = parse_channels(channels) if channels is not None else None
    model = None if calibration is None else read_calibration(calibration)
    paths = [bag.resolve() for bag in (*bags, *([holdout] if holdout else []))]
    for place, path in enumerate(paths):
        if path in paths[:place]:
            raise RefusedError(f"{path.name} is given twice: leave one of them out")
    with counting_bar("reading") as advance:
        readings = [read(bag, names, (start, end), advance) for bag in bags]
        held = read(holdout, names, (None, None), advance) if holdout else None
    with progress_bar("judging") as (bar, task):
        result = check(
            readings,
            calibration=model,
            holdout=held,
            channels=wanted,
            effects=effects,
            progress=lambda channel: bar.update(task, description=channel),
        )
    for facts in result.recordings:
        console.print(facts_table(facts))
    for channel in result.channels:
        show_table(channel_table(channel, _left_out(result)), WHY_UNKNOWN)
        if any(one.level is not Level.IDENTIFIABLE for one in channel.effects):
            console.print(limits_table(channel))
        for line in remarks(channel):
            click.echo(line)
    write_json(json_path, result.as_json())


def _left_out(result: Check) -> str:
    single = len(result.recordings) == 1
    return f"the last quarter of {result.holdout}" if single else result.holdout


def facts_table(facts: RecordingFacts) -> Table:
    """Return what is in a recording."""
    table = new_table(facts.name, ("recorded", "what"))
    gaps = f"{counted(facts.gaps, 'gap')}, the longest {duration(facts.longest_gap)}" if facts.gaps else "no gap"
    rate = quantity(facts.rate, "Hz", DIGITS)
    table.add_row("accelerometer", f"{duration(facts.duration)}, {counted(facts.samples, 'sample')} at {rate}, {gaps}")
    for one in facts.channels:
        unit = unit_of(one.name)
        told = [f"{quantity(one.lowest, unit)} to {quantity(one.highest, unit)}"]
        told += [f"noise of a sample {quantity(one.noise, unit, DIGITS)}"]
        told += [f"{counted(one.clipped, 'sample')} at a limit of the range"] if one.clipped else []
        told += ["vibration"] if one.vibrating else []
        told += [counted(one.shocks, "shock")] if one.shocks else []
        table.add_row(one.name, ", ".join(told))
    heat = facts.thermistor
    bad = ", ".join(f"{count(number)} {name.replace('_', ' ')}" for name, number in heat.bad.items()) or "all plausible"
    table.add_row(
        "thermistor",
        f"{counted(heat.samples, 'sample')} at {quantity(heat.rate, 'Hz', DIGITS)}, "
        f"noise {quantity(heat.noise, '°C', 2)}, {bad}",
    )
    table.add_row("temperature", f"{heat.lowest:.1f} to {heat.highest:.1f} °C in {heat.sweeps} coolings and heatings")
    table.add_row("ramps", ", ".join(f"{rate:.2g}" for rate in heat.rates) + " °C/min" if heat.rates else "none")
    table.add_row("soaks", ", ".join(map(_soak, heat.soaks)) or "none")
    table.add_row("power-ons", count(heat.power_ons))
    table.add_row("other inputs", ", ".join(facts.inputs) or "none")
    if facts.averaged > 1:
        table.add_row("judged on", f"means of {counted(facts.averaged, 'sample')}")
    return table


def _soak(seconds: float) -> str:
    """Return the length of a soak, to whole minutes where it has any: that is how ovens are programmed."""
    return duration(60.0 * round(seconds / 60.0) if seconds >= 60.0 else seconds)


def channel_table(channel: ChannelCheck, left_out: str) -> Table:
    """Return the verdicts on a channel."""
    title = f"{channel.name}, {shown_unit(unit_of(channel.name))}; judged on all but {left_out}"
    table = new_table(title, ("effect", "named?", FROM, "at", "most like"), numbers=(FROM,))
    for one in channel.effects:
        shown = "yes" if one.level is Level.IDENTIFIABLE else one.level.value
        table.add_row(
            one.name,
            Text(shown, style=COLOURS[one.level]),
            number(one.size, DIGITS),
            _parameter(one),
            f"{one.rival} {one.correlation:.2f}" if one.rival else UNKNOWN,
        )
    return table


def limits_table(channel: ChannelCheck) -> Table:
    """Return for the effects that a small size of does not show why that is, and what to record."""
    table = new_table(f"{channel.name}: what is missing", ("effect", "why", "remedy"))
    for one in channel.effects:
        if one.level is not Level.IDENTIFIABLE:
            table.add_row(one.name, one.reason, one.remedy)
    return table


def _parameter(one: EffectCheck) -> str:
    found = one.parameter
    if found is None:
        return UNKNOWN
    span = f"{number(found.low, DIGITS)} to {number(found.high, DIGITS)}"
    return f"{quantity(found.value, found.unit, DIGITS)} ({span})"


def remarks(channel: ChannelCheck) -> list[str]:
    """Return what a table cannot say."""
    unit = unit_of(channel.name)
    said = [
        f"{channel.name}: noise of a mean of 10 s {quantity(channel.noise, unit, DIGITS)}, "
        f"drift {quantity(channel.drift, unit)}; a size up to {quantity(channel.small, unit, DIGITS)} counts as small"
    ]
    said += [
        f"{channel.name}: {pair.first} and {pair.second} could not be told apart (correlation {pair.correlation:.3f})"
        for pair in channel.look_alikes
    ]
    return said
