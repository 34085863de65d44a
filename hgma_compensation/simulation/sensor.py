"""The accelerometer: what each axis answers to, and what it reads."""

from collections import Counter
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import AXES
from hgma_compensation.simulation.description import Scenario
from hgma_compensation.simulation.drift import static_drift
from hgma_compensation.simulation.effect import Events, Surroundings
from hgma_compensation.simulation.filters import resonance
from hgma_compensation.simulation.motion import true_acceleration
from hgma_compensation.simulation.noise import Streams, flicker_noise, white_noise
from hgma_compensation.simulation.oven import GRID, Temperatures, power_state
from hgma_compensation.simulation.readout import digitise
from hgma_compensation.simulation.thermometers import package_temperature, supply_voltage
from hgma_compensation.simulation.vibration import vibration_power

Array = NDArray[np.float64]

RESOLVED = 4.0
"""Sample rate over the first mode's frequency from which on its ringing is computed."""


class Sensor:
    """The state of the sensor at the accelerometer's sample times, powered or not.

    time: (n,) s. temperature: (n,) °C. acceleration: (n, 3) m/s², what the sensor undergoes.
    """

    def __init__(self, scenario: Scenario, oven: Temperatures, streams: Streams) -> None:
        """Compute what all axes share."""
        self._scenario, self._oven, self._streams = scenario, oven, streams
        self.time = np.arange(int(scenario.oven.duration * scenario.accelerometer_rate)) / scenario.accelerometer_rate
        self.temperature = np.interp(self.time, oven.time, oven.sensor)
        self.acceleration = true_acceleration(scenario, self.time, streams)
        self._felt = self._mechanical()
        self._power = vibration_power(scenario.motion.vibrations, self.time)
        self._rate = np.interp(self.time, oven.time, np.gradient(oven.sensor, GRID))
        second, supply = scenario.second_thermometer, scenario.supply
        package = oven.sensor if second is None else package_temperature(second, oven)
        self._package = np.interp(self.time, oven.time, package)
        deviation = np.zeros_like(self.time)
        self._voltage = deviation if supply is None else supply_voltage(supply, self.time) - supply.nominal

    def drift(self, axis: str) -> Array:
        """Return all that temperature and effects add to an axis (n,), m/s²."""
        described, around = self._scenario.axes[axis], self._surroundings(axis)
        total = around.static(self.temperature) + described.rate_drift * 60.0 * self._rate
        earlier: Counter[str] = Counter()
        for applied in self._scenario.effects:
            if axis in applied.axes:
                # Numbered among its own kind, so that another effect does not change what this one draws.
                random = self._streams(f"{applied.name} {earlier[applied.name]} {axis}")
                earlier[applied.name] += 1
                total = total + applied.effect.drift(around, random)
        return total

    def readings(self, axis: str, drift: Array) -> Array:
        """Return the readings (n,) of an axis with that drift (n,), m/s²."""
        described, rate = self._scenario.axes[axis], self._scenario.accelerometer_rate
        count = len(self.time)
        white = white_noise(count, described.white_noise, rate, self._streams(f"white noise {axis}"))
        flicker = flicker_noise(count, described.bias_instability, self._streams(f"flicker noise {axis}"))
        return digitise(self._felt[:, AXES.index(axis)] + drift + white + flicker, described)

    def _mechanical(self) -> Array:
        """Return the acceleration (n, 3) as the proof mass on its beams renders it."""
        mode, rate = self._scenario.first_mode, self._scenario.accelerometer_rate
        if mode is None or rate < RESOLVED * mode.frequency:
            return self.acceleration
        respond = partial(resonance, frequency=mode.frequency, quality=mode.quality, step=1.0 / rate)
        return np.stack([respond(column) for column in self.acceleration.T], axis=1)

    def _surroundings(self, axis: str) -> Surroundings:
        shocks = [shock for shock in self._scenario.motion.shocks if shock.axis == axis]
        return Surroundings(
            step=1.0 / self._scenario.accelerometer_rate,
            time=self.time,
            temperature=self.temperature,
            rate=self._rate,
            temperature_2=self._package,
            voltage_deviation=self._voltage,
            powered=power_state(self._scenario.powered, self.time),
            vibration_power=self._power[:, AXES.index(axis)],
            acceleration=self._felt,
            column=AXES.index(axis),
            shocks=Events(np.array([s.time + s.width for s in shocks]), np.array([s.peak for s in shocks])),
            grid=self._oven.time,
            grid_temperature=self._oven.sensor,
            static=partial(static_drift, axis=self._scenario.axes[axis]),
        )
