"""The acceleration that the sensor really undergoes."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import AXES
from hgma_compensation.simulation.description import Scenario
from hgma_compensation.simulation.motion_description import Orientation, Shock
from hgma_compensation.simulation.noise import Streams
from hgma_compensation.simulation.vibration import vibrate

Array = NDArray[np.float64]


def true_acceleration(scenario: Scenario, time: Array, streams: Streams) -> Array:
    """Return the specific force (n, 3) in m/s² at times (n,) in s."""
    motion, axes = scenario.motion, scenario.axes
    still = np.array([axes[axis].true_value if axis in axes else 0.0 for axis in AXES])
    total = held_force(still, motion.orientations, time)
    for shock in motion.shocks:
        total[:, AXES.index(shock.axis)] += half_sine(shock, time)
    for number, vibration in enumerate(motion.vibrations):
        random = streams(f"vibration {number}")
        total[:, AXES.index(vibration.axis)] += vibrate(vibration, time, scenario.accelerometer_rate, random)
    for waveform in motion.waveforms:
        total[:, AXES.index(waveform.axis)] += mean_of_waveform(waveform.times, waveform.values, time)
    return total


def held_force(still: Array, orientations: tuple[Orientation, ...], time: Array) -> Array:
    """Return the force (n, 3): still (3,) at first, then each orientation, turned to along a straight line."""
    corners, forces = [-np.inf], [still]
    for orientation in orientations:
        corners += [orientation.time, orientation.time + orientation.turn]
        forces += [forces[-1], np.array(orientation.specific_force)]
    known = np.array(corners[1:]) if len(corners) > 1 else np.zeros(1)
    values = np.array(forces[1:]) if len(forces) > 1 else np.array(forces)
    return np.stack([np.interp(time, known, values[:, column]) for column in range(len(AXES))], axis=1)


def half_sine(shock: Shock, time: Array) -> Array:
    """Return peak·sin(π(t − t0)/width) (n,) inside the pulse, zero outside."""
    phase = (time - shock.time) / shock.width
    return np.asarray(np.where((phase >= 0.0) & (phase <= 1.0), shock.peak * np.sin(np.pi * phase), 0.0))


def mean_of_waveform(times: Array, values: Array, time: Array) -> Array:
    """Return a waveform (k,) as means over the sampling intervals about the times (n,), zero outside of it.

    Means, because a sample rate far below the waveform's must keep its velocity change.
    """
    if len(time) < 2:
        return np.zeros(len(time))
    half = 0.5 * (time[1] - time[0])
    velocity = _velocity(times, values, np.r_[time - half, time[-1] + half])
    return np.asarray(np.diff(velocity) / (2.0 * half))


def _velocity(times: Array, values: Array, at: Array) -> Array:
    """Return the integral (m,) up to times ``at`` of straight lines between values (k,) at times (k,)."""
    steps = np.diff(times)
    passed = np.r_[0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * steps)]
    inside = np.clip(at, times[0], times[-1])
    piece = np.clip(np.searchsorted(times, inside, side="right") - 1, 0, len(steps) - 1)
    since = inside - times[piece]
    slope = np.diff(values)[piece] / steps[piece]
    return np.asarray(passed[piece] + since * (values[piece] + 0.5 * slope * since))
