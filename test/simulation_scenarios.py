"""Small scenarios for the tests of the simulator."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from hgma_compensation.simulation.description import AppliedEffect, Axis, Oven, Scenario, Step, Supply, Thermometer
from hgma_compensation.simulation.effects import EFFECTS
from hgma_compensation.simulation.oven_test import simulate_with_truth

ROOT = Path(__file__).parents[1]
PARAMS = ROOT / "params"
CYCLE = Oven(25.0, 30.0, (Step(60.0, 2.0, 10.0), Step(-10.0, 2.0, 10.0), Step(25.0, 2.0, 10.0)))


def quiet_scenario(**changes: Any) -> Scenario:
    """Return an axis z at 1 Hz that drifts by 700 m/s², without noise, in one cycle of 100 min."""
    scenario = Scenario(
        name="made",
        seed=1,
        sensor_id="imu_link",
        oven=CYCLE,
        thermistor_rate=1.0,
        thermistor_noise=0.0,
        accelerometer_rate=1.0,
        axes={"z": Axis(true_value=9.81, drift_span=700.0)},
        second_thermometer=Thermometer(1.0, 0.0, lag=5.0),
        supply=Supply(1.0, 5.0),
    )
    return replace(scenario, **changes)


def effect_on_z(name: str, scenario: Scenario | None = None, **parameters: Any) -> NDArray[np.float64]:
    """Return what an effect adds to the readings (n,) of z, all else equal."""
    scenario = scenario or quiet_scenario()
    applied = replace(scenario, effects=(AppliedEffect(name, EFFECTS[name](**parameters), ("z",)),))
    with_effect, without = simulate_with_truth(applied), simulate_with_truth(scenario)
    difference = with_effect.truth.drift[:, 2] - without.truth.drift[:, 2]
    # The truth and the readings must tell of the same effect.
    read = with_effect.recording.values[:, 2] - without.recording.values[:, 2]
    np.testing.assert_allclose(read, difference, atol=1e-9 * max(1.0, np.abs(read).max()))
    return np.asarray(difference)


def write_scenario(folder: Path, base: str = "oven_test.yaml", **changes: Any) -> Path:
    """Write a shipped scenario with a short programme and some sections changed, and return its path."""
    document = yaml.safe_load((PARAMS / base).read_text(encoding="utf-8"))
    document["oven"]["program"] = [{"to": 35.0, "rate": 10.0, "soak": 1.0}]
    document.update(changes)
    path = folder / "scenario.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    return path
