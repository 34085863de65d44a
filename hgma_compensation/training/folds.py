"""Which blocks are left out together when a fit is validated: whole temperature cycles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.training.blocks import Blocks

TURN = 0.15
"""A turning point counts when the temperature then moves back by this share of the whole span."""

MOST_FOLDS = 6
BLOCKS_WITHOUT_TURNS = 8


@dataclass(frozen=True)
class Folds:
    """index: (n,) fold of each block, 0 to count - 1. kind: what a fold is, in words."""

    index: NDArray[np.int64]
    count: int
    kind: str


def cycle_folds(blocks: Blocks) -> Folds:
    """Return folds of whole cycles (down and up), of half cycles where there are fewer than two cycles.

    A model with memory or rate terms always predicts the left-out rest of the same ramp well; only a
    sweep that it has not seen tells whether it has learned the sensor. A single sweep cannot be
    validated in this way: it is split into stretches of time, and the kind says so.
    """
    half = half_cycles(blocks)
    halves = int(half.max()) + 1
    if halves >= 4:
        return _limited(half // 2, "temperature cycles")
    if halves >= 2:
        return _limited(half, "half cycles of temperature")
    position = np.arange(len(blocks.time)) * BLOCKS_WITHOUT_TURNS // len(blocks.time)
    return _limited(position % (BLOCKS_WITHOUT_TURNS // 2), "stretches of a single sweep")


def half_cycles(blocks: Blocks) -> NDArray[np.int64]:
    """Return the number, from 0 and counting through all recordings, of the sweep each block lies in."""
    temperature = blocks.features[:, 0]
    threshold = TURN * float(np.ptp(temperature))
    numbers, offset = np.empty(len(temperature), dtype=np.int64), 0
    for recording in np.unique(blocks.recording):
        rows = np.flatnonzero(blocks.recording == recording)
        turns = turning_points(temperature[rows], threshold)
        numbers[rows] = offset + np.searchsorted(turns, np.arange(len(rows)), side="right")
        offset = int(numbers[rows].max()) + 1
    return numbers


def turning_points(temperature: NDArray[np.float64], threshold: float) -> list[int]:
    """Return the indices of extremes from which the temperature moves back by more than the threshold."""
    turns: list[int] = []
    low = high = 0
    direction = 0
    for i, value in enumerate(temperature.tolist()):
        low = i if value < temperature[low] else low
        high = i if value > temperature[high] else high
        if direction >= 0 and temperature[high] - value > threshold:
            if direction > 0:
                turns.append(high)
            direction, low = -1, i
        elif direction <= 0 and value - temperature[low] > threshold:
            if direction < 0:
                turns.append(low)
            direction, high = 1, i
    return turns


def _limited(index: NDArray[np.int64], kind: str) -> Folds:
    folded = index % MOST_FOLDS
    return Folds(folded, int(folded.max()) + 1, kind)
