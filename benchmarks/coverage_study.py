"""Whether ``hgma check`` is true: effects of twice the size that it gives, diagnosed; and effects that it says no to.

Run: python -m benchmarks.coverage_study [--effects NAME,...] [--programmes NAME,...] [--tries 6]
About a quarter of a minute a diagnosis. The effects come from the simulator, whose laws are not the fitted ones.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click
import numpy as np
import yaml
from numpy.typing import NDArray

from hgma_compensation.coverage.check import check
from hgma_compensation.coverage.effect_names import parse_effects
from hgma_compensation.coverage.reading import reading_of
from hgma_compensation.coverage.result import EffectCheck, Level
from hgma_compensation.diagnosis.diagnose import diagnose
from hgma_compensation.diagnosis.recordings import HELD_OUT
from hgma_compensation.effects.registry import kinds
from hgma_compensation.programme.plan import plan
from hgma_compensation.programme.programme import Wishes
from hgma_compensation.programme.trial_run import EXAMPLES, Document, scenario_document
from hgma_compensation.recording.recording import Recording
from hgma_compensation.simulation.oven_test import simulate_with_truth
from hgma_compensation.simulation.scenario import read_scenario
from hgma_compensation.training.methods import Method
from hgma_compensation.training.train import TrainingOptions, train

CHANNEL, COLUMN = "linear_acceleration.z", 2
TIMES = 2.0
"""Size of the effect that is diagnosed over that which check gives."""

FASTEST = 8.0
"""°C/min of the oven: four times the usual rate makes recordings of three hours."""

KNOWN = 1500.0
"""s, of creep: soaks of 40 min."""


@dataclass(frozen=True)
class Outcome:
    """One effect in one kind of programme. size: that check gives. true_size: of the effect diagnosed.

    named: what each diagnosis named first, "" for nothing. right: how many named the effect, whatever else with it.
    """

    effect: str
    programme: str
    level: Level
    size: float | None
    true_size: float
    named: tuple[str, ...]
    right: int


def excited(name: str, seed: int) -> Document:
    """Return the programme that is planned for an effect, which the sensor has."""
    known = KNOWN if name == "stress_relaxation" else None
    wishes = Wishes(effects=(name,), ramp_rate=FASTEST, mission_rate=FASTEST, time_constant=known)
    return scenario_document(plan(wishes), (name,), seed)


def idle(name: str, seed: int) -> Document:
    """Return three cycles at one rate in which nothing else happens, though everything is logged."""
    document = excited("supply_voltage", seed)
    cycle = [{"to": to, "rate": FASTEST, "soak": 2.0} for to in (-10.0, 60.0)]
    document["oven"]["program"] = [*cycle, *cycle, *cycle, {"to": 25.0, "rate": FASTEST, "soak": 30.0}]
    del document["supply_voltage"]["steps"]
    document["second_thermometer"] = {"rate": 1.0, "noise": 0.02}
    document["accelerometer"]["axes"]["y"] = {"drift_span_g": 500.0, "white_noise_g_per_h": 17130.0}
    known = {"time_constant": KNOWN} if name == "stress_relaxation" else {}
    document["effects"] = [{"effect": name, "axes": ["z"], **EXAMPLES[name], **known}]
    return document


def one_cycle(name: str, seed: int) -> Document:
    """Return a single cycle, of which less than four coolings and heatings are learned from."""
    document = excited(name, seed)
    steps = [(-10.0, 15.0), (60.0, 15.0), (25.0, 30.0)]
    document["oven"]["program"] = [{"to": to, "rate": FASTEST, "soak": soak} for to, soak in steps]
    return document


PROGRAMMES = {"planned": excited, "idle": idle, "one-cycle": one_cycle}


def study(name: str, document: Document, programme: str, tries: int) -> Outcome:
    """Return what check says without the effect, and what diagnoses name with it."""
    plain, _ = recorded(document)
    (channel,) = check([reading_of(plain)], channels=(CHANNEL,), effects=(name,)).channels
    said: EffectCheck = channel.effects[0]
    named, right, true_size = [], 0, 0.0
    for seed in range(tries):
        recording, effect = recorded({**document, "seed": 100 + seed})
        learned = effect[: int((1.0 - HELD_OUT) * len(effect))]
        own = float(np.std(learned))
        true_size = own if said.size is None or said.level is Level.NOT else TIMES * said.size
        values = recording.values.copy()
        values[:, COLUMN] += effect * (true_size / own if own else 0.0)
        found = names_of(replace(recording, values=values))
        named.append(found[0] if found else "")
        right += (kinds()[name].family or name) in found
    return Outcome(name, programme, said.level, said.size, true_size, tuple(named), right)


def recorded(document: Document) -> tuple[Recording, NDArray[np.float64]]:
    """Return the recording of a scenario without its effect, and what the effect adds to z, (n,) m/s²."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "scenario.yaml"
        path.write_text(yaml.safe_dump(document), encoding="utf-8")
        scenario = read_scenario(path)
    with_effect, without = (simulate_with_truth(s) for s in (scenario, replace(scenario, effects=())))
    return without.recording, with_effect.truth.drift[:, COLUMN] - without.truth.drift[:, COLUMN]


def names_of(recording: Recording) -> list[str]:
    """Return the names that a diagnosis finds, those included that carry a part only."""
    calibration = train([recording], TrainingOptions(method=Method.POLYNOMIAL_RATE, channels=(CHANNEL,)))
    (channel,) = diagnose([recording], calibration).channels
    return [effect.name for effect in (*channel.effects, *channel.partial)]


def row(outcome: Outcome) -> str:
    """Return a line of a Markdown table."""
    size = "-" if outcome.size is None else f"{outcome.size:.3g}"
    others = sorted({name or "nothing" for name in outcome.named})
    return (
        f"| {outcome.effect} | {outcome.programme} | {outcome.level.value} | {size} | {outcome.true_size:.3g} | "
        f"{outcome.right} of {len(outcome.named)} | {', '.join(others)} |"
    )


@click.command()
@click.option("--effects", "text", default="all", show_default=True)
@click.option("--tries", type=click.IntRange(min=1), default=6, show_default=True)
@click.option("--programmes", default=",".join(PROGRAMMES), show_default=True)
@click.option("--json", "json_path", type=click.Path(path_type=Path))
def main(text: str, tries: int, programmes: str, json_path: Path | None) -> None:
    """Print the table, line by line."""
    click.echo("| effect | programme | check says | from, m/s² | true size | named rightly | named first |")
    click.echo("| --- | --- | --- | ---: | ---: | ---: | --- |")
    figures: list[dict[str, Any]] = []
    names: Sequence[str] = parse_effects(text) or tuple(EXAMPLES)
    for name in names:
        for programme in programmes.split(","):
            document = PROGRAMMES[programme](name, 1)
            outcome = study(name, document, programme, tries if programme == "planned" else max(1, tries // 3))
            click.echo(row(outcome))
            figures.append({**vars(outcome), "level": outcome.level.value})
    if json_path is not None:
        json_path.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
