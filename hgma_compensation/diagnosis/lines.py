"""Lines in the spectrum of what is left: candidates for periodic interference."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.periodic_interference import PeriodicInterference
from hgma_compensation.recording.sliced import in_parts

Array = NDArray[np.float64]

FEWEST_PERIODS = 12
"""In the longest run: slower waves cannot be told from drift."""

SHORTEST = 2.2
"""Shortest period over the length of a block."""

OVERSAMPLING = 4
AT_ONCE = 64
"""Frequencies whose waves are in memory together, two megabytes of them with two thousand means."""

STRONGEST = 3
TRIALS = 1e5
"""Independent periods that such a search tries, for the p-value of the largest line."""


def power_spectrum(problem: Problem, residual: Array) -> tuple[Array, Array]:
    """Return frequencies (f,) in Hz and the power (f,) of a whitened residual (n,), mean of the runs; 1 on noise."""
    blocks = problem.scene.blocks
    runs = [np.flatnonzero(blocks.run == number) for number in np.unique(blocks.run)]
    longest = max(float(blocks.stamps[rows[-1]] - blocks.stamps[rows[0]]) * 1e-9 for rows in runs)
    frequencies = np.arange(FEWEST_PERIODS / longest, 1.0 / (SHORTEST * problem.block), 1.0 / (OVERSAMPLING * longest))
    power = np.zeros(len(frequencies))
    for rows in runs:
        seconds = (blocks.stamps[rows] - blocks.stamps[rows[0]]) * 1e-9
        for part in in_parts(len(frequencies), AT_ONCE):
            waves = -2j * np.pi * frequencies[part, None] * seconds
            np.exp(waves, out=waves)
            power[part] += np.abs(waves @ residual[rows]) ** 2 / len(rows)
    return frequencies, power / len(runs)


def line_candidates(state: State) -> list[Effect]:
    """Return lines at the strongest peaks, over periods fine enough that all runs stay in phase.

    The phase may go on from run to run, or begin anew with each power-on.
    """
    frequencies, power = power_spectrum(state.problem, state.projection.residual)
    if not len(frequencies):
        return []
    blocks = state.problem.scene.blocks
    whole = float(blocks.stamps[-1] - blocks.stamps[0]) * 1e-9
    width = frequencies[1] - frequencies[0] if len(frequencies) > 1 else 0.0
    found: list[Effect] = []
    left = power.copy()
    for _ in range(STRONGEST):
        peak = int(np.argmax(left))
        left[max(0, peak - 2 * OVERSAMPLING) : peak + 2 * OVERSAMPLING + 1] = 0.0
        for from_power_on, length in ((0.0, whole), (1.0, state.problem.survey.duration)):
            around = frequencies[peak] + np.arange(-1.5 * width, 1.5 * width, 0.2 / length)
            found += [
                PeriodicInterference(float(1.0 / f), float(state.problem.survey.origin), from_power_on=from_power_on)
                for f in around[around > 0.0]
            ]
    return found
