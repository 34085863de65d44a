"""The description of an oven test, read from a YAML file."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from hgma_compensation import schema_check
from hgma_compensation.channels import AXES
from hgma_compensation.errors import RefusedError

LARGEST_FILE = 1 << 20
MOST_SAMPLES = 50_000_000


@dataclass(frozen=True)
class Step:
    """Ramp of the set-point to a temperature (°C) at a rate (°C/min), then a soak (min)."""

    to: float
    rate: float
    soak: float


@dataclass(frozen=True)
class Oven:
    """start: °C of oven and sensor. time_constant: s by which the sensor follows the set-point."""

    start: float
    time_constant: float
    program: tuple[Step, ...]

    @property
    def duration(self) -> float:
        """Length of the programme, s."""
        before, total = self.start, 0.0
        for step in self.program:
            total += 60.0 * (abs(step.to - before) / step.rate + step.soak)
            before = step.to
        return total


@dataclass(frozen=True)
class Axis:
    """true_value: m/s². drift_span: m/s² over -10...60 °C. rate_drift: m/s² per °C/min. white_noise: m/s²/√Hz."""

    true_value: float
    drift_span: float
    rate_drift: float
    white_noise: float


@dataclass(frozen=True)
class Scenario:
    """An oven test. thermistor_rate, accelerometer_rate: Hz. thermistor_noise: °C."""

    name: str
    seed: int
    sensor_id: str
    oven: Oven
    thermistor_rate: float
    thermistor_noise: float
    accelerometer_rate: float
    axes: Mapping[str, Axis]


def read_scenario(path: Path) -> Scenario:
    """Return the scenario in a YAML file; raises RefusedError naming the field that is wrong."""
    path = Path(path)
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise RefusedError(f"scenario {path} is larger than {LARGEST_FILE} bytes")
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RefusedError(
            f"scenario {path} cannot be read ({error.strerror}): give a YAML file such as those in params/"
        ) from None
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise RefusedError(f"scenario {path} is no YAML: {error}") from None
    try:
        schema_check.check(document, schema_check.load_schema(__package__, "scenario.schema.json"))
        path_of_bad = schema_check.find_non_finite(document)
        if path_of_bad is not None:
            raise RefusedError(f"{path_of_bad} is not finite")
        return _decode(path.stem, document)
    except RefusedError as refusal:
        raise RefusedError(f"scenario {path}: {refusal}") from None


def _decode(name: str, document: dict[str, Any]) -> Scenario:
    oven, thermistor, accelerometer = document["oven"], document["thermistor"], document["accelerometer"]
    scenario = Scenario(
        name=name,
        seed=int(document["seed"]),
        sensor_id=document.get("sensor_id", "imu_link"),
        oven=Oven(oven["start"], oven["time_constant"], tuple(Step(**step) for step in oven["program"])),
        thermistor_rate=thermistor["rate"],
        thermistor_noise=thermistor["noise"],
        accelerometer_rate=accelerometer["rate"],
        axes={axis: Axis(**accelerometer["axes"][axis]) for axis in AXES if axis in accelerometer["axes"]},
    )
    if not scenario.axes:
        raise RefusedError("accelerometer.axes is empty: describe at least one of x, y, z")
    samples = scenario.oven.duration * max(scenario.accelerometer_rate, scenario.thermistor_rate)
    if not 2 <= samples <= MOST_SAMPLES:
        raise RefusedError(
            f"oven.program lasts {scenario.oven.duration:g} s, which makes {samples:.0f} samples: "
            f"2 to {MOST_SAMPLES} fit"
        )
    return scenario
