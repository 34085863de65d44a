"""Reads the description of an oven test from a YAML file."""

import math
from pathlib import Path
from typing import Any, cast

from hgma_compensation import schema_check
from hgma_compensation.bounded_files import read_text
from hgma_compensation.errors import RefusedError
from hgma_compensation.plain_values import check_plain
from hgma_compensation.plain_yaml import load_plain
from hgma_compensation.simulation.description import Axis, FirstMode, Oven, Scenario, Step
from hgma_compensation.simulation.effects.telegraph_noise import TelegraphNoise
from hgma_compensation.simulation.motion_and_effects import decode_effects, decode_motion
from hgma_compensation.simulation.oven import GRID
from hgma_compensation.simulation.sections import (
    check_times,
    decode_axes,
    decode_oven,
    decode_powered,
    decode_supply,
    decode_thermometer,
)

__all__ = ["Axis", "Oven", "Scenario", "Step", "read_scenario"]

LARGEST_FILE = 1 << 20
MOST_SAMPLES = 20_000_000


def read_scenario(path: Path) -> Scenario:
    """Return the scenario in a YAML file; raises RefusedError naming the field that is wrong."""
    path = Path(path)
    try:
        document = load_plain(read_text(path, LARGEST_FILE))
        check_plain(document)
        _check_schema(document)
        return _decode(path, cast(dict[str, Any], document))
    except RefusedError as refusal:
        raise RefusedError(f"scenario {path}: {refusal}") from None


def _check_schema(document: Any) -> None:
    try:
        schema_check.check(document, schema_check.load_schema(__package__, "scenario.schema.json"))
    except RefusedError as refusal:
        raise RefusedError(f"{refusal}; params/oven_test.yaml shows what a scenario holds") from None


def _decode(path: Path, document: dict[str, Any]) -> Scenario:
    second, supply = document.get("second_thermometer"), document.get("supply_voltage")
    thermistor, accelerometer = decode_thermometer(document["thermistor"]), document["accelerometer"]
    axes = decode_axes(accelerometer["axes"])
    oven = decode_oven(document["oven"])
    scenario = Scenario(
        name=path.stem,
        seed=int(document["seed"]),
        sensor_id=document.get("sensor_id", "imu_link"),
        oven=oven,
        thermistor_rate=thermistor.rate,
        thermistor_noise=thermistor.noise,
        thermistor_lag=thermistor.lag,
        thermistor_resolution=thermistor.resolution,
        accelerometer_rate=accelerometer["rate"],
        axes=axes,
        block=int(accelerometer.get("block", 1)),
        first_mode=FirstMode(**accelerometer["first_mode"]) if "first_mode" in accelerometer else None,
        second_thermometer=None if second is None else decode_thermometer(second),
        supply=None if supply is None else decode_supply(supply),
        powered=decode_powered(document.get("power", [{"start": 0.0}]), oven.duration),
        motion=decode_motion(document.get("motion", {}), path.parent),
        effects=decode_effects(document.get("effects", []), tuple(axes), document),
        ground_truth=document.get("ground_truth", False),
    )
    _check_length(scenario)
    _check_switches(scenario)
    check_times(document, oven.duration)
    return scenario


def _check_length(scenario: Scenario) -> None:
    rates = [scenario.accelerometer_rate, scenario.thermistor_rate]
    rates += [part.rate for part in (scenario.second_thermometer, scenario.supply) if part is not None]
    duration = scenario.oven.duration
    if not (math.isfinite(duration) and duration * scenario.accelerometer_rate >= 2.0):
        raise RefusedError(f"oven.program lasts {duration:g} s, which is less than two samples of the accelerometer")
    if duration * max(*rates, 1.0 / GRID) > MOST_SAMPLES:
        raise RefusedError(
            f"oven.program lasts {duration:g} s, which makes {duration * max(*rates, 1.0 / GRID):.0f} samples: "
            f"2 to {MOST_SAMPLES} fit"
        )


def _check_switches(scenario: Scenario) -> None:
    for index, applied in enumerate(scenario.effects):
        if isinstance(effect := applied.effect, TelegraphNoise):
            switches = scenario.oven.duration * 2.0 / (effect.mean_low + effect.mean_high)
            if switches > MOST_SAMPLES:
                raise RefusedError(
                    f"effects[{index}] switches {switches:.3g} times: give mean_low and mean_high that make it "
                    f"{MOST_SAMPLES} at most"
                )
