"""Structure that is in no catalogue, of size about one."""

from collections.abc import Callable

import numpy as np

from benchmarks.loop.other_world import STEP, Array, World, follow, relaxation


def random_walk(around: World, random: np.random.Generator) -> Array:
    """Return a zero that wanders without end."""
    return np.cumsum(random.standard_normal(len(around.time))) * np.sqrt(STEP / 3600.0)


def telegraph_noise(around: World, random: np.random.Generator) -> Array:
    """Return a zero that jumps between two levels, stays of 5 to 20 minutes in the mean."""
    stays = random.exponential(random.uniform(300.0, 1200.0), int(around.time[-1] / 60.0) + 200)
    return np.asarray(np.searchsorted(np.cumsum(stays), around.time) % 2, dtype=np.float64)


def humidity_wave(around: World, random: np.random.Generator) -> Array:
    """Return a slow wave of hours, irregular, which no channel shows."""
    wave = np.sin(2.0 * np.pi * around.time / random.uniform(9000.0, 20000.0) + random.uniform(0.0, 6.28))
    return np.asarray(wave + 1.5 * follow(relaxation(len(around.time), 1500.0, random), 1500.0))


def wandering_oscillation(around: World, random: np.random.Generator) -> Array:
    """Return an oscillation whose period wanders by a third about some minutes."""
    period = random.uniform(150.0, 500.0) * np.exp(0.35 * relaxation(len(around.time), 400.0, random))
    return np.sin(np.cumsum(2.0 * np.pi * STEP / period))


def random_steps(around: World, random: np.random.Generator) -> Array:
    """Return steps of random height at random times, four to ten an hour."""
    count = random.poisson(random.uniform(4.0, 10.0) * around.time[-1] / 3600.0) + 4
    total, heights = np.zeros_like(around.time), random.standard_normal(count)
    for time, height in zip(random.uniform(0.0, around.time[-1], count), heights, strict=True):
        total += height * (around.time >= time)
    return total - follow(total, 14400.0)


UNKNOWN: dict[str, Callable[[World, np.random.Generator], Array]] = {
    form.__name__: form for form in (random_walk, telegraph_noise, humidity_wave, wandering_oscillation, random_steps)
}
