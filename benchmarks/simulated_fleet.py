"""A fleet of simulated sensors, each with a drift and noise of its own; some are bad, some recordings are damaged.

Every folder holds ``train`` (two temperature cycles) and ``holdout`` (one at another rate), short and slowly sampled.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from hgma_compensation.recording.bag_writer import write_recording
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.recording.recording import Series
from hgma_compensation.simulation.description import AppliedEffect, Axis, Oven, Scenario, Step
from hgma_compensation.simulation.effects.hysteresis import Hysteresis
from hgma_compensation.simulation.oven_test import simulate

TRAINING = Oven(25.0, 30.0, tuple(Step(to, 8.0, 2.0) for to in (-10.0, 60.0, -10.0, 60.0)))
HOLDOUT = Oven(25.0, 30.0, tuple(Step(to, 6.0, 2.0) for to in (60.0, -10.0, 25.0)))
RATE = 1.0
"""Hz of the accelerometer: slow, so that two hundred sensors take minutes."""

SPAN = 5367.0 * STANDARD_GRAVITY
WHITE_NOISE, BIAS_INSTABILITY = 17130.0 * STANDARD_GRAVITY / 3600.0, 4720.0 * STANDARD_GRAVITY / 3600.0
"""The typical sensor: raw figures of Zhu et al. 2019 in SI."""

NOISY, LOOPING = 17, 29
"""Every so many sensors there is one of three times the noise, and one with a hysteresis."""


def name_of(number: int) -> str:
    """Return the name of a sensor."""
    return f"sensor_{number:04d}"


def sensor_scenario(seed: int, number: int, oven: Oven, run: int) -> Scenario:
    """Return the oven test of one sensor; its drift depends on seed and number, its noise on the run too."""
    random = np.random.default_rng([seed, number])
    spans, rates, noises, flicker = random.normal(size=4)
    axis = Axis(
        true_value=STANDARD_GRAVITY,
        drift_span=SPAN * (1.0 + 0.06 * float(spans)),
        rate_drift=40.0 * float(np.exp(0.3 * rates)),
        white_noise=WHITE_NOISE * float(np.exp(0.08 * noises)) * (3.0 if number % NOISY == NOISY - 1 else 1.0),
        bias_instability=BIAS_INSTABILITY * float(np.exp(0.1 * flicker)),
    )
    loop = AppliedEffect("hysteresis", Hysteresis(width=0.02 * SPAN, threshold=8.0), ("z",))
    return Scenario(
        name="simulated",
        seed=int(np.random.SeedSequence([seed, number, run]).generate_state(1)[0]),
        sensor_id="imu_link",
        oven=oven,
        thermistor_rate=0.5,
        thermistor_noise=0.03,
        accelerometer_rate=RATE,
        axes={"z": axis},
        effects=(loop,) if number % LOOPING == LOOPING - 1 else (),
    )


def write_sensor(folder: Path, seed: int, number: int) -> None:
    """Write the recordings of one sensor into its new folder."""
    folder.mkdir(parents=True)
    for run, (name, oven) in enumerate((("train", TRAINING), ("holdout", HOLDOUT))):
        write_recording(simulate(sensor_scenario(seed, number, oven, run)), folder / name)


def write_without_temperature(folder: Path, seed: int, number: int) -> None:
    """Write a sensor whose thermistor was not recorded."""
    folder.mkdir(parents=True)
    recording = simulate(sensor_scenario(seed, number, TRAINING, 0))
    write_recording(replace(recording, temperature=Series.empty()), folder / "train")


def write_cut_off(folder: Path, seed: int, number: int) -> None:
    """Write a sensor whose recording ends in the middle of its file."""
    write_sensor(folder, seed, number)
    (file,) = (folder / "train").glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def write_fleet(folder: Path, sensors: int, seed: int = 1, damaged: bool = True) -> tuple[str, ...]:
    """Write so many sensors into a folder and return the names of those that cannot be calibrated.

    damaged: the last two are, where there are more than two.
    """
    broken = (write_without_temperature, write_cut_off) if damaged and sensors > 2 else ()
    for number in range(sensors):
        last = number - (sensors - len(broken))
        write = broken[last] if last >= 0 else write_sensor
        write(folder / name_of(number), seed, number)
    return tuple(name_of(sensors - len(broken) + index) for index in range(len(broken)))
