"""What is done to the sensor beside heating it: power, supply, motion, shocks, vibration, heat from one side."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from benchmarks.loop.experiment import NOMINAL, Experiment
from benchmarks.loop.programme import HOURS, programme
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.simulation.description import Heating, Powered, VoltageStep
from hgma_compensation.simulation.motion_description import Orientation, Shock, Vibration


def experiment(parts: Iterable[str], random: np.random.Generator, hours: float = HOURS) -> Experiment:
    """Return an experiment in which the parts happen."""
    made = programme(random, hours)
    chosen = frozenset(parts)
    whole = tuple(Powered(start, end) for start, end in made.windows)
    plan = Experiment(made.steps, made.windows, whole, chosen, hours / HOURS)
    for name in sorted(chosen):
        plan = PARTS[name](plan, random)
    return plan


def power_cycles(plan: Experiment, random: np.random.Generator) -> Experiment:
    """Switch the sensor off for 6 to 15 minutes, once or twice a recording."""
    powered = []
    for start, end in plan.windows:
        length, last = end - start, start
        places = [random.uniform(0.25, 0.65)] if random.integers(2) else [*random.uniform((0.2, 0.6), (0.35, 0.8))]
        for place in places:
            off = start + place * length
            powered.append(Powered(last, off))
            last = off + random.uniform(360.0, 900.0) * plan.shrink
        powered.append(Powered(last, end))
    return replace(plan, powered=tuple(powered))


def heating(plan: Experiment, random: np.random.Generator) -> Experiment:
    """Heat or cool the package from one side, three times a recording."""
    times = _spread(plan, random, 3)
    pulses = [
        Heating(t, t + random.uniform(400.0, 1200.0) * plan.shrink, _sign(random) * random.uniform(3.0, 8.0))
        for t in times
    ]
    return replace(plan, heating=tuple(pulses))


def supply(plan: Experiment, random: np.random.Generator) -> Experiment:
    """Step the supply by 1 to 3 % of its nominal value, and back, several times a recording."""
    steps, now = [], 0.0
    for time in _spread(plan, random, 5):
        wanted = _sign(random) * random.uniform(0.01, 0.03) * NOMINAL
        steps.append(VoltageStep(time, wanted - now))
        now = wanted
    return replace(plan, voltage_steps=tuple(steps))


def lateral(plan: Experiment, random: np.random.Generator) -> Experiment:
    """Move the sensor along y: levels of up to 1500 g, reached at once or within minutes."""
    held = [(0.0, 0.0, 1.0)]
    for time in _spread(plan, random, 12):
        turn = 2.0 if random.integers(2) else random.uniform(60.0, 180.0) * plan.shrink
        held.append((time, random.uniform(-1500.0, 1500.0), turn))
    return replace(plan, orientations=tuple(_held(t, turn, y=level) for t, level, turn in held))


def levels(plan: Experiment, random: np.random.Generator) -> Experiment:
    """Spin the sensor up to +A, then -A, for half a minute each, every eight minutes; A of three sizes, 500 to 2000 g.

    In between it is at rest.
    """
    sizes = random.uniform(1500.0, 2000.0) * np.array([1.0, 0.66, 0.33])
    hold, held = 32.0 * plan.shrink, [(0.0, 0.0)]
    for number, time in enumerate(_spread(plan, random, 15)):
        size, first = sizes[number % 3], _sign(random)
        held += [(time, first * size), (time + hold, -first * size), (time + 2.0 * hold, 0.0)]
    return replace(plan, orientations=tuple(_held(t, 1.0, z=level) for t, level in held))


def vibration(plan: Experiment, random: np.random.Generator) -> Experiment:
    """Shake the sensor along z between 1.5 and 2.4 Hz, four bursts of minutes a recording, 50 to 300 g rms."""
    bursts = [
        (time, random.uniform(240.0, 720.0) * plan.shrink, np.exp(random.uniform(np.log(50.0), np.log(300.0))))
        for time in _spread(plan, random, 4)
    ]
    made = [Vibration(t, t + length, "z", rms * STANDARD_GRAVITY, 1.5, 2.4) for t, length, rms in bursts]
    return replace(plan, vibrations=tuple(made))


def shocks(plan: Experiment, random: np.random.Generator) -> Experiment:
    """Hit the sensor four times a recording, peaks of 1000 to 4000 g, each size once in either direction.

    So what a recording leaves behind for good adds up to nothing for the next one. A shock that strikes while the
    sensor is off, and that nobody could know of, is put off until it is on again.
    """
    times = [_powered(plan, time) for time in _spread(plan, random, 4)]
    peaks = []
    for _ in plan.windows:
        large, small = random.uniform(2500.0, 4000.0), random.uniform(1000.0, 2500.0)
        peaks += [*random.permutation([large, -large, small, -small])]
    hits = [Shock(t, "z", peak * STANDARD_GRAVITY, 0.8) for t, peak in zip(times, peaks, strict=True)]
    return replace(plan, shocks=tuple(hits))


PARTS: dict[str, Callable[[Experiment, np.random.Generator], Experiment]] = {
    part.__name__: part for part in (power_cycles, heating, supply, lateral, levels, vibration, shocks)
}


def _spread(plan: Experiment, random: np.random.Generator, count: int) -> list[float]:
    """Return ``count`` times in each recording, in order, one in each of as many equal stretches of it."""
    times = []
    for start, end in plan.windows:
        places = (np.arange(count) + random.uniform(0.1, 0.5, count)) / count
        times += (start + places * (end - start)).tolist()
    return times


def _powered(plan: Experiment, time: float) -> float:
    """Return a time at which the sensor has been on for a while, the time itself if it has."""
    settled = 120.0 * plan.shrink
    if any(one.start + settled <= time < one.end - settled for one in plan.powered):
        return time
    later = [one.start + settled for one in plan.powered if one.start + settled > time]
    return min(later) if later else max(one.end for one in plan.powered) - settled


def _held(time: float, turn: float, y: float = 0.0, z: float = 0.0) -> Orientation:
    """Return a level of y and z in g, above the weight along z."""
    return Orientation(time, (0.0, y * STANDARD_GRAVITY, (1.0 + z) * STANDARD_GRAVITY), turn)


def _sign(random: np.random.Generator) -> float:
    return 1.0 if random.integers(2) else -1.0
