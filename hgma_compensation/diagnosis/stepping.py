"""Memories of the temperature stepped along runs, several runs at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.carried_memory import enough
from hgma_compensation.diagnosis.runs import read_smoothed
from hgma_compensation.diagnosis.smoothing import Smoothed
from hgma_compensation.effects.memory import Bank
from hgma_compensation.stamps import Stamps, seconds_between

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Path:
    """What memories are told of a run, and where their states are wanted.

    stamps: (k,) ns and temperature: (k,) °C, inside the calibrated range, of the samples that move memories. wanted:
    (n,) ns; index: (n,) the newest sample before each; there: (n,) °C at them.
    """

    stamps: Stamps
    temperature: Array
    wanted: Stamps
    index: NDArray[np.int64]
    there: Array

    @classmethod
    def along(cls, run: Smoothed, limits: tuple[float, float], wanted: Stamps) -> "Path":
        """Return the path of a run to increasing stamps (n,), temperatures inside the limits (°C)."""
        used = enough(run.stamps)
        stamps, temperature = run.stamps[used], np.clip(run.temperature, *limits)[used]
        index = np.maximum(np.searchsorted(stamps, wanted, side="right") - 1, 0)
        return cls(stamps, temperature, wanted, index, np.clip(read_smoothed(run, wanted)[0], *limits))


def walk(bank: Bank, paths: Sequence[Path], starts: Array) -> tuple[list[Array], Array]:
    """Return the states (n, m) where each path wants them, and those (r, m) at the ends of paths of equal length.

    starts: (r, m). The paths move side by side: a step costs the calls of one however many there are, and a row hears
    nothing of the others, so every path's states are those it has alone. Beyond its end a shorter path stands still.
    """
    temperature, steps = _side_by_side(paths)
    run = np.repeat(np.arange(len(paths)), [len(path.index) for path in paths])
    index = np.concatenate([path.index for path in paths])
    order = np.argsort(index, kind="stable")
    # Of step k: the wanted rows from reached[k] to reached[k + 1], in that order.
    reached = np.searchsorted(index[order], np.arange(len(steps) + 1)).tolist()
    run, kept, state = run[order], np.empty((len(index), bank.size)), starts
    for k in range(len(steps)):
        if k:
            state = bank.advance(state, steps[k], temperature[k - 1], temperature[k])
        if reached[k] < reached[k + 1]:
            part = slice(reached[k], reached[k + 1])
            kept[order[part]] = state[run[part]]
    ends = np.cumsum([len(path.index) for path in paths])[:-1]
    return [_onward(bank, path, own) for path, own in zip(paths, np.split(kept, ends), strict=True)], state


def _side_by_side(paths: Sequence[Path]) -> tuple[Array, Array]:
    """Return the temperatures and the steps' lengths in s, (k, r, 1) each, of paths with up to k samples."""
    longest = max(len(path.stamps) for path in paths)
    temperature, steps = np.zeros((2, longest, len(paths), 1))
    for r, path in enumerate(paths):
        count = len(path.stamps)
        temperature[:count, r, 0], temperature[count:, r, 0] = path.temperature, path.temperature[-1]
        steps[:count, r, 0] = np.diff(path.stamps, prepend=path.stamps[:1]) * 1e-9
    return temperature, steps


def _onward(bank: Bank, path: Path, states: Array) -> Array:
    """Return the states (n, m) at the wanted stamps, given those at the samples before them."""
    age = np.maximum(seconds_between(path.wanted, path.stamps[path.index]), 0.0)
    return bank.advance(states, age[:, None], path.temperature[path.index][:, None], path.there[:, None])
