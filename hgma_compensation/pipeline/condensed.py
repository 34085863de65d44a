"""What a state file keeps of the samples of a slow input: enough for a calibration that is swapped in later."""

from collections.abc import Iterable
from itertools import pairwise
from math import isfinite

from hgma_compensation.pipeline.remembered import THINNED, Remembered
from hgma_compensation.pipeline.sample_ring import Pair
from hgma_compensation.temperature.track import TAKEN, judge, turn_back
from hgma_compensation.temperature.updates import POWER_OFF, Updates

NEWEST = 256
"""Samples that are kept as they came: four minutes at 1 Hz."""

OLDER = 2048
"""Samples kept before them, one in THINNED: 17 hours."""

LARGEST = 1e6
"""°C, V: a larger reading is a broken sensor's."""


def condensed(remembered: Remembered) -> Remembered:
    """Return the newest samples as they came and one in THINNED of those before; the last before a power-off stays."""
    samples = _usable(remembered)
    if not samples:
        return Remembered()
    split = max(0, len(samples) - NEWEST)
    older = _thinned(samples[: split + 1])[:-1] if split else []
    kept = older[-OLDER:] + samples[split:]
    dropped = older[:-OLDER] + kept[:1]
    # A power-on after the first sample is one from before time began anew.
    power_on = dropped[0][0] if remembered.power_on is None else min(remembered.power_on, dropped[0][0])
    return Remembered.of(_power_on(power_on, dropped), kept)


def _usable(samples: Iterable[Pair]) -> list[Pair]:
    """Return the samples that a replay would use, at the stamps that they have after all that the clock did."""
    pairs = [(stamp, value) for stamp, value in samples if isfinite(value) and abs(value) <= LARGEST]
    if all(before[0] < after[0] for before, after in pairwise(pairs)):
        return pairs
    updates = Updates()
    for stamp, value in pairs:
        outcome = judge(stamp, value, (-LARGEST, LARGEST), updates)
        if outcome in TAKEN:
            turn_back(outcome, stamp, updates)
            updates.append(stamp, value, 0.0)
    return list(zip(updates.stamps.tolist(), updates.temperatures.tolist(), strict=True))


def _thinned(samples: list[Pair]) -> list[Pair]:
    """Return one sample in THINNED, each before a power-off, and the last."""
    kept = samples[:1]
    for sample, following in pairwise(samples[1:]):
        # Whatever the spacing, thinning must not make a pause that looks like a lack of power.
        if sample[0] - kept[-1][0] >= THINNED or following[0] - kept[-1][0] > POWER_OFF:
            kept.append(sample)
    return kept + samples[-1:] if len(samples) > 1 else kept


def _power_on(power_on: int, samples: list[Pair]) -> int:
    """Return the stamp of the newest power-on up to the last of the samples."""
    for before, after in pairwise(samples):
        if after[0] - before[0] > POWER_OFF:
            power_on = after[0]
    return power_on
