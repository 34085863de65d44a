"""Random streams for the Kalman stage: intervals as clocks make them, and what may happen to a sensor."""

from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings

WHITE, REFERENCE, EPOCH = 0.3, 9.81, 1_700_000_000_000_000_000
ROUNDED_CLOCKS = ("rounded", "late by 1 ns")
CLOCKS = ("even", "jittered", "late", "pauses", "two rates", "blocks", *ROUNDED_CLOCKS)
EVENTS = ("rest", "shock", "step", "vibration", "weak", "many")


@dataclass(frozen=True)
class Stream:
    """Samples (n,) of a sensor at stamps (n,), and the settings that fit its noise."""

    stamps: NDArray[np.int64]
    values: NDArray[np.float64]
    settings: FilterSettings
    deviation: float


def clock(kind: str, count: int, random: np.random.Generator) -> NDArray[np.int64]:
    """Return stamps of about 3 kHz: 333 300 ns, or as the kind says."""
    steps = np.full(count, 333_300)
    if kind == "rounded":
        return EPOCH + np.rint(np.arange(count) * 1e9 / 3000.0).astype(np.int64)
    if kind == "jittered":
        steps += 3 * random.integers(-10_000, 10_000, count)  # none that differ by the rounding that is held over
    elif kind == "blocks":  # even within each, whose headers jitter
        steps[::500] += 3 * random.integers(-10_000, 10_000, len(steps[::500]))
    elif kind in ("late", "late by 1 ns"):
        least = -1 if kind == "late by 1 ns" else -2
        steps = random.choice([333_300, 0, least, -1_000_000, 666_600], count, p=[0.97, 0.01, 0.005, 0.005, 0.01])
    elif kind == "pauses":
        steps[random.integers(0, count, 3)] = random.choice([5_000_000, 100_000_000, 5_000_000_000], 3)
    elif kind == "two rates":
        steps[count // 2 :] = random.choice([333_302, 50_000, 1_000_000, 20_000_000])
    return EPOCH + np.cumsum(steps)


def happenings(kind: str, count: int, random: np.random.Generator) -> NDArray[np.float64]:
    """Return what the sensor shows beside its noise, in deviations of that."""
    shown, at = np.zeros(count), int(random.integers(0, count))
    if kind == "shock":
        shown[at : at + int(random.integers(1, 60))] = random.choice([-1e6, 8.0, 300.0, 1e200])
    elif kind == "step":
        shown[at:] = random.choice([-30.0, 2.0, 1e5])
    elif kind == "vibration":
        shown[at : at + 1500] = 20.0 * np.sin(0.7 * np.arange(len(shown[at : at + 1500])))
    elif kind == "weak":
        shown[at : at + 100] = np.linspace(0.0, 3.0, len(shown[at : at + 100]))
    elif kind == "many":
        shown[random.integers(0, count, 12)] = 20.0
    return shown


@st.composite
def streams(draw: st.DrawFn, clocks: tuple[str, ...] = CLOCKS, longest: int = 4000) -> Stream:
    """Return a stream whose filter settles within it, or not."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(2, longest))
    seconds = draw(st.sampled_from([0.0005, 0.005, 0.02, 10.0]))
    settings = FilterSettings(
        draw(st.sampled_from([FilterMode.SMOOTH, FilterMode.BIAS])),
        RandomWalkNoise.with_time_constant(WHITE, seconds),
        wander=draw(st.sampled_from([0.0, 2.0])),
        initial_bias=0.5,
    )
    stamps = clock(draw(st.sampled_from(clocks)), count, random)
    deviation = WHITE / np.sqrt(333_300e-9)
    shown = happenings(draw(st.sampled_from(EVENTS)), count, random) + random.standard_normal(count)
    return Stream(stamps, REFERENCE + deviation * shown, settings, deviation)
