"""``hgma check``."""

from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from hgma_compensation.calibration.document import read_calibration
from hgma_compensation.channels import parse_channels, unit_of
from hgma_compensation.cli import options
from hgma_compensation.cli.terminal import check_folder, console, counting_bar, progress_bar, write_json
from hgma_compensation.coverage.check import check
from hgma_compensation.coverage.effect_names import parse_effects
from hgma_compensation.coverage.reading import read
from hgma_compensation.coverage.result import ChannelCheck, Check, EffectCheck, Level, RecordingFacts
from hgma_compensation.errors import RefusedError
from hgma_compensation.report.words import number
from hgma_compensation.topics import TopicNames

COLOURS = {Level.IDENTIFIABLE: "green", Level.WEAKLY: "yellow", Level.NOT: "red"}


@click.command("check", epilog="Example: hgma check oven_test")
@options.bags_argument
@click.option(
    "--effects", "effects_text", metavar="NAME,...|all", default="all", show_default=True, help="Effects to judge."
)
@click.option(
    "--calibration",
    metavar="CAL",
    type=options.PathArgument(),
    help="Calibration that a diagnosis is to start from. Default: a cubic with rate terms, fitted here.",
)
@click.option(
    "--holdout",
    metavar="BAG",
    type=options.PathArgument(),
    help="Recording that nothing is learned from, as for hgma diagnose. Without it: the last of several, or the last "
    "quarter of a single one.",
)
@click.option(
    "--channels", metavar="LIST", help="Comma-separated. Default: those of the calibration, or all there are."
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
    if json_path is not None:
        check_folder(json_path)
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
        console.print(channel_table(channel, _left_out(result)))
        for line in remarks(channel):
            click.echo(line)
    write_json(json_path, result.as_json())


def _left_out(result: Check) -> str:
    single = len(result.recordings) == 1
    return f"the last quarter of {result.holdout}" if single else result.holdout


def facts_table(facts: RecordingFacts) -> Table:
    """Return what is in a recording."""
    table = Table(title=Text(facts.name), show_header=False)
    gaps = f"{facts.gaps} gaps, the longest {facts.longest_gap:.3g} s" if facts.gaps else "no gap"
    table.add_row(
        "accelerometer", f"{facts.duration / 3600.0:.2f} h, {facts.samples} samples at {facts.rate:.4g} Hz, {gaps}"
    )
    for one in facts.channels:
        told = [f"{one.lowest:.5g} to {one.highest:.5g} {unit_of(one.name)}, noise of a sample {one.noise:.3g}"]
        told += [f"{one.clipped} samples at a limit of the range"] if one.clipped else []
        told += ["vibration"] if one.vibrating else []
        told += [f"{one.shocks} shocks"] if one.shocks else []
        table.add_row(f"  {one.name}", ", ".join(told))
    heat = facts.thermistor
    bad = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in heat.bad.items()) or "all plausible"
    table.add_row("thermistor", f"{heat.samples} samples at {heat.rate:.3g} Hz, noise {heat.noise:.2g} °C, {bad}")
    table.add_row("  temperature", f"{heat.lowest:.1f} to {heat.highest:.1f} °C in {heat.sweeps} coolings and heatings")
    table.add_row("  ramps", ", ".join(f"{rate:.2g}" for rate in heat.rates) + " °C/min" if heat.rates else "none")
    table.add_row("  soaks", ", ".join(f"{soak / 60.0:.0f}" for soak in heat.soaks) + " min" if heat.soaks else "none")
    table.add_row("power-ons", str(heat.power_ons))
    table.add_row("other inputs", ", ".join(facts.inputs) or "none")
    if facts.averaged > 1:
        table.add_row("judged on", f"means of {facts.averaged} samples")
    return table


def channel_table(channel: ChannelCheck, left_out: str) -> Table:
    """Return the verdicts on a channel."""
    table = Table(title=Text(f"{channel.name}, {unit_of(channel.name)}; judged on all but {left_out}"))
    for heading in ("effect", "identifiable", "shows from", "at", "most like", "why"):
        table.add_column(heading, justify="right" if heading == "shows from" else "left")
    for one in channel.effects:
        shown = "yes" if one.level is Level.IDENTIFIABLE else one.level.value
        table.add_row(
            one.name,
            Text(shown, style=COLOURS[one.level]),
            "-" if one.size is None else number(one.size),
            _parameter(one),
            f"{one.rival} {one.correlation:.2f}" if one.rival else "-",
            Text(one.reason),
        )
    return table


def _parameter(one: EffectCheck) -> str:
    found = one.parameter
    if found is None:
        return "-"
    return f"{number(found.value)} ({number(found.low)}...{number(found.high)}) {found.unit}".rstrip()


def remarks(channel: ChannelCheck) -> list[str]:
    """Return what a table cannot say."""
    unit = unit_of(channel.name)
    said = [
        f"{channel.name}: noise of a mean of 10 s {channel.noise:.3g} {unit}, drift {channel.drift:.4g} {unit}; "
        f"a size up to {channel.small:.3g} {unit} counts as small"
    ]
    said += [
        f"{channel.name}: {pair.first} and {pair.second} could not be told apart (correlation {pair.correlation:.3f})"
        for pair in channel.look_alikes
    ]
    said += [f"{channel.name}: for {one.name} {one.remedy}" for one in channel.effects if one.remedy]
    return said
