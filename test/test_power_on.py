"""What a power-on costs: hardly more error than there is anyway."""

import numpy as np
import pytest
from simulation_scenarios import quiet_scenario

from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.simulation.description import Axis, Oven, Powered, Step
from hgma_compensation.simulation.oven_test import simulate
from hgma_compensation.stamps import seconds_between
from hgma_compensation.training.blocks import group_means
from hgma_compensation.training.genetic import GeneticSettings
from hgma_compensation.training.train import TrainingOptions, train

OVEN = Oven(
    25.0, 30.0, tuple(Step(to, rate, 2.0) for to, rate in ((60.0, 2.0), (-10.0, 2.0), (60.0, 1.0), (25.0, 2.0)))
)
OFF = ((900.0, 1300.0), (2600.0, 2900.0), (4000.0, 4080.0), (6000.0, 6600.0))
"""s without power: in ramps, so that the temperature after them is another one."""

EDGES = np.concatenate([[0.0], np.ravel(OFF), [np.inf]])
POWERED = tuple(Powered(float(start), float(end)) for start, end in EDGES.reshape(-1, 2))
PAPERS = Axis(9.81, drift_span=5400.0 * STANDARD_GRAVITY, white_noise=4.76 * STANDARD_GRAVITY)


@pytest.mark.parametrize("seed", [1, 2])
def test_the_minute_after_a_power_on_is_compensated_nearly_as_well_as_all_the_rest(seed: int) -> None:
    scenario = quiet_scenario(
        seed=seed, oven=OVEN, powered=POWERED, axes={"z": PAPERS}, thermistor_noise=0.02, accelerometer_rate=5.0
    )
    recording = simulate(scenario)
    calibration = train([recording], TrainingOptions(seed=seed, genetic=GeneticSettings(generations=20)))
    values = compensate_recording(recording, calibration).values
    time = seconds_between(recording.stamps, recording.start)
    since_power_on = time - EDGES[::2][np.searchsorted(EDGES[::2], time, side="right") - 1]
    block = np.floor(time / 5.0).astype(np.int64)
    time, since, error = group_means(block, np.column_stack([time, since_power_on, values - np.mean(values)])).T
    started, rest = error[(since < 60.0) & (time > EDGES[1])], error[since >= 60.0]
    assert np.sqrt(np.mean(started**2)) <= 1.5 * np.sqrt(np.mean(rest**2))
