"""The oven's programmes of the four recordings of one sensor, and the hours between them."""

from dataclasses import dataclass, replace

import numpy as np

from hgma_compensation.simulation.description import Step

HOURS = 2.0
"""Length of a recording for which the programmes below are written."""

REST = 25.0
"""°C of the room in which the sensor lies before, between and after the recordings."""

LOWEST, HIGHEST = -10.0, 60.0
INSIDE = 1.5
"""°C by which the held-out programme stays inside of the others' range."""

RETURN_RATE = 2.0
"""°C/min at which the oven comes back to the room's temperature after a recording."""


@dataclass(frozen=True)
class Programme:
    """steps: of all recordings and the pauses between them. windows: (start, end) of each recording, s."""

    steps: tuple[Step, ...]
    windows: tuple[tuple[float, float], ...]


def programme(random: np.random.Generator, hours: float = HOURS) -> Programme:
    """Return three programmes to learn from and one to judge on, each ``hours`` long, at rest for hours in between.

    Shorter recordings have the same temperatures at faster rates.
    """
    shrink = hours / HOURS
    parts = [slow(random), middle(random), fast(random), held_out(random)]
    steps: list[Step] = []
    windows, now = [], 0.0
    for part in parts:
        filled = _fill(part, 60.0 * HOURS)
        last = filled[-1].to
        back = Step(REST, RETURN_RATE, float(random.uniform(1.0, 3.0)) * 60.0 * HOURS)
        windows.append((now, now + 3600.0 * hours))
        now += 3600.0 * hours + 60.0 * shrink * (abs(last - REST) / RETURN_RATE + back.soak)
        steps += [*filled, back]
    return Programme(tuple(Step(s.to, s.rate / shrink, s.soak * shrink) for s in steps), tuple(windows))


def slow(random: np.random.Generator) -> tuple[Step, ...]:
    """Return half a cycle at 0.7...0.8 °C/min, on the cold or on the hot side."""
    rate, side = random.uniform(0.7, 0.8), random.integers(2)
    end, turn = (LOWEST, 35.0) if side else (HIGHEST, 15.0)
    return Step(end, rate, 2.0), Step(turn, rate, 1.0)


def middle(random: np.random.Generator) -> tuple[Step, ...]:
    """Return a whole cycle at about 1.5 °C/min."""
    rate = random.uniform(1.4, 1.6)
    return Step(HIGHEST, rate, 1.0), Step(LOWEST, rate, 1.0), Step(random.uniform(28.0, 34.0), rate, 0.6)


def fast(random: np.random.Generator) -> tuple[Step, ...]:
    """Return a cycle at 3 °C/min with a minor loop at 2 °C/min."""
    quick, less = random.uniform(2.8, 3.0), random.uniform(1.9, 2.1)
    low, high = random.uniform(16.0, 22.0), random.uniform(40.0, 47.0)
    if random.integers(2):
        ends = Step(LOWEST, quick, 1.0), Step(HIGHEST, quick, 1.5)
        return *ends, Step(low, less, 0.3), Step(high, less, 0.3), Step(LOWEST, quick, 0.8)
    ends = Step(HIGHEST, quick, 1.0), Step(LOWEST, quick, 1.5)
    return *ends, Step(high, less, 0.3), Step(low, less, 0.3), Step(HIGHEST, quick, 0.8)


def held_out(random: np.random.Generator) -> tuple[Step, ...]:
    """Return a cycle at rates of its own, 2.2...2.4 and 1.1...1.3 °C/min, with a minor loop."""
    quick, less, back = random.uniform(2.2, 2.4), random.uniform(1.1, 1.3), random.uniform(1.7, 1.85)
    low, high = random.uniform(12.0, 18.0), random.uniform(33.0, 40.0)
    cold, hot = LOWEST + INSIDE, HIGHEST - INSIDE
    ends = (hot, low, high, cold) if random.integers(2) else (cold, high, low, hot)
    first, second, third, fourth = ends
    turns = Step(first, quick, 1.0), Step(second, less, 0.5), Step(third, quick, 0.5), Step(fourth, quick, 1.2)
    return *turns, Step(REST, back, 0.5)


def _fill(steps: tuple[Step, ...], minutes: float) -> list[Step]:
    """Return the steps with soaks, so far relative, that fill the programme to its length."""
    corners = [REST, *(step.to for step in steps)]
    moving = sum(abs(step.to - before) / step.rate for before, step in zip(corners, steps, strict=False))
    unit = (minutes - moving) / sum(step.soak for step in steps)
    return [replace(step, soak=step.soak * unit) for step in steps]
