"""The oven test that the paper's table is made on: what to train on, what to judge on, and the truth of both."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.recording import Recording
from hgma_compensation.simulation.oven_test import simulate
from hgma_compensation.simulation.scenario import Oven, Scenario, Step, read_scenario

PARAMETERS = Path(__file__).parents[1] / "params"
STILL_HOURS, STILL_RATE = 24.0, 10.0
"""Of the record at rest, h and Hz: long enough for a flat part of the Allan curve ten filter time constants out."""


@dataclass(frozen=True)
class OvenTest:
    """whole: the recording. clean: the same without noise. still: a record at rest at 25 °C.

    split: s from the start at which the held-out cycle begins. channel: the one judged. true_value: m/s².
    """

    whole: Recording
    clean: Recording
    still: Recording
    split: float
    channel: str
    true_value: float
    white_noise: float

    @property
    def training(self) -> Recording:
        """The part that every stage is made from."""
        return self.whole.cut(None, self.split)

    def column(self, recording: Recording) -> NDArray[np.float64]:
        """Return the samples (n,) of the channel."""
        return recording.values[:, CHANNELS.index(self.channel)]


def oven_test(path: Path, seed: int, still_hours: float = STILL_HOURS) -> OvenTest:
    """Simulate the scenario with its own seed plus ``seed`` - 1, so that seed 1 is the scenario as it is written."""
    written = read_scenario(path)
    scenario = replace(written, seed=written.seed + seed - 1)
    axis = next(iter(scenario.axes))
    return OvenTest(
        whole=simulate(scenario),
        clean=simulate(without_noise(scenario)),
        still=simulate(still_scenario(scenario, still_hours)),
        split=held_out_start(scenario.oven),
        channel=f"linear_acceleration.{axis}",
        true_value=scenario.axes[axis].true_value,
        white_noise=scenario.axes[axis].white_noise,
    )


def held_out_start(oven: Oven) -> float:
    """Return the time (s) of the first ramp at the last step's rate; raises RefusedError if another rate follows it."""
    steps = oven.program
    first = next(number for number, step in enumerate(steps) if step.rate == steps[-1].rate)
    if first == 0 or any(step.rate != steps[-1].rate for step in steps[first:]):
        raise RefusedError("the oven's programme must end with a cycle at a ramp rate that no step before it has")
    return replace(oven, program=steps[:first]).duration


def without_noise(scenario: Scenario) -> Scenario:
    """Return the scenario with a perfect thermistor and a perfect readout."""
    perfect = {"white_noise": 0.0, "bias_instability": 0.0, "lsb": 0.0}
    axes = {name: replace(axis, **perfect) for name, axis in scenario.axes.items()}
    return replace(scenario, thermistor_noise=0.0, thermistor_resolution=0.0, axes=axes)


def still_scenario(scenario: Scenario, hours: float) -> Scenario:
    """Return the same sensor left alone at 25 °C, outside of the oven and its ripple."""
    oven = replace(scenario.oven, start=25.0, program=(Step(25.0, 1.0, 60.0 * hours),), ripple=None)
    return replace(scenario, oven=oven, accelerometer_rate=STILL_RATE, seed=scenario.seed + 1_000_000)
