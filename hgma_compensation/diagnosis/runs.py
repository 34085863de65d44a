"""Recordings with their thermometers smoothed."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.smoothing import Smoothed, smooth, thinned
from hgma_compensation.effects.memory import POWER_OFF
from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.recording import Series
from hgma_compensation.recording.sliced import Sampled
from hgma_compensation.stamps import NANOSECONDS, Stamps, seconds_between
from hgma_compensation.temperature.trend_filter import TrendNoise
from hgma_compensation.training.thermistor import FEWEST, usable

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """One recording's smoothed inputs. power_on: (m,) ns, the last start before each thermistor sample."""

    recording: Sampled
    smoothed: Smoothed
    power_on: Stamps
    second: Smoothed | None


def make_run(recording: Sampled, noise: TrendNoise) -> Run:
    """Return a recording with its thermometers smoothed; raises RefusedError where the first one says nothing."""
    if len(usable(recording.temperature).stamps) < FEWEST:
        raise RefusedError(f"{recording.name}: fewer than {FEWEST} usable thermistor samples: leave it out")
    first = smoothed_series(usable(recording.temperature), noise)
    starts = power_ons(first.stamps)
    power_on = first.stamps[starts[np.searchsorted(starts, np.arange(len(first.stamps)), side="right") - 1]]
    other = usable(recording.temperature_2)
    second = smoothed_series(other, noise) if len(other.stamps) > 2 else None
    return Run(recording, first, power_on, second)


def smoothed_series(good: Series, noise: TrendNoise) -> Smoothed:
    """Return a series of usable samples smoothed from each power-on to the next."""
    bounds = [*power_ons(good.stamps).tolist(), len(good.stamps)]
    parts = [smooth(*thinned(good.stamps[a:b], good.values[a:b], noise)) for a, b in pairwise(bounds)]
    return Smoothed(*(np.concatenate([getattr(p, name) for p in parts]) for name in Smoothed.__dataclass_fields__))


def power_ons(stamps: Stamps) -> NDArray[np.int64]:
    """Return the indices of the first sample and of those after a pause without power."""
    pauses = np.flatnonzero(np.diff(stamps) > POWER_OFF * NANOSECONDS) + 1
    return np.concatenate([[0], pauses]).astype(np.int64)


def since_power_on(run: Run, stamps: Stamps) -> Array:
    """Return the time (n,) in s since the last power-on before stamps (n,)."""
    return np.maximum(seconds_between(stamps, power_on_before(run, stamps)), 0.0)


def power_on_before(run: Run, stamps: Stamps) -> Stamps:
    """Return the last power-on (n,) before stamps (n,), ns."""
    index = np.maximum(np.searchsorted(run.smoothed.stamps, stamps, side="right") - 1, 0)
    return np.asarray(run.power_on[index])


def read_smoothed(smoothed: Smoothed, stamps: Stamps) -> tuple[Array, Array]:
    """Return temperature (n,) °C and rate (n,) °C/s at stamps (n,)."""
    origin = smoothed.stamps[0]
    at, grid = (stamps - origin) * 1e-9, (smoothed.stamps - origin) * 1e-9
    return np.interp(at, grid, smoothed.temperature), np.interp(at, grid, smoothed.rate)


def read_earlier(run: Run, stamps: Stamps, seconds: float) -> Array:
    """Return the temperature (n,) that many s before stamps (n,), at most back to the power-on before them."""
    wanted = np.maximum(stamps - round(seconds * NANOSECONDS), power_on_before(run, stamps))
    return read_smoothed(run.smoothed, wanted)[0]
