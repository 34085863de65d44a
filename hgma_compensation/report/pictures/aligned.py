"""Responses to events laid on top of each other: corners of the temperature, soaks, shocks.

An event counts with what the fitted effect does at it, so that heating and cooling do not cancel out; data and fit
go through the same arithmetic.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.report.pictures.evidence import Evidence
from hgma_compensation.report.pictures.ramps import still_rate

Array = NDArray[np.float64]

CORNER = 0.35
"""Change of the rate, over that of a fast ramp, that makes a corner."""

APART = 150.0
"""s between corners that count as two."""


@dataclass(frozen=True)
class Aligned:
    """rows, after: (m,) blocks and their seconds after an event. event: (m,) which one. resting: (m,) zero of it."""

    rows: NDArray[np.int64]
    after: Array
    event: NDArray[np.int64]
    resting: NDArray[np.bool_]
    weights: Array

    def mean(self, values: Array, edges: Array) -> Array:
        """Return the response (bins,) of values (n,) between edges (bins + 1,) of time; 1 is the fitted response."""
        taken = values[self.rows]
        count = np.bincount(self.event, self.resting, minlength=len(self.weights))
        zero = np.bincount(self.event, self.resting * taken, minlength=len(self.weights)) / np.maximum(count, 1.0)
        weight = np.where(count > 0, self.weights, 0.0)[self.event]
        place = np.searchsorted(edges, self.after, side="right") - 1
        inside = (place >= 0) & (place < len(edges) - 1)
        top = np.bincount(place[inside], (weight * (taken - zero[self.event]))[inside], minlength=len(edges) - 1)
        bottom = np.bincount(place[inside], (weight**2)[inside], minlength=len(edges) - 1)
        return np.where(bottom > 1e-6 * bottom.max(initial=0.0), top / np.maximum(bottom, 1e-300), np.nan)


def align(
    evidence: Evidence,
    starts: NDArray[np.int64],
    before: float,
    after: float,
    *,
    rest_at_end: bool = False,
    memory: bool = True,
) -> Aligned | None:
    """Return blocks around starts (rows of blocks, sorted), from ``before`` s before to ``after`` s after each.

    The zero of a response is what goes before the event, or its end. memory: whether the effect is one of the
    temperature, so that its static part is none of it. None where there is no event to see.
    """
    rows, times, events, resting, weights = [], [], [], [], []
    run, seconds = evidence.blocks.run, evidence.seconds
    fitted = evidence.contribution - evidence.static if memory else evidence.contribution
    for number, start in enumerate(starts.tolist()):
        low, high = seconds[start] - before, seconds[start] + after
        if number:
            low = max(low, seconds[starts[number - 1]] + 0.5 * APART)
        if number + 1 < len(starts) and run[starts[number + 1]] == run[start]:
            high = min(high, seconds[starts[number + 1]] - 0.25 * APART)
        mine = np.flatnonzero((run == run[start]) & (seconds >= low) & (seconds <= high))
        elapsed = seconds[mine] - seconds[start]
        zero = elapsed > 0.75 * elapsed.max(initial=0.0) if rest_at_end else elapsed < 0.0
        full = np.abs(elapsed) < 60.0 if rest_at_end else elapsed > 0.6 * elapsed.max(initial=0.0)
        if zero.sum() < 2 or full.sum() < 2:
            continue
        share = fitted[mine]
        weights.append(float(share[full].mean() - share[zero].mean()))
        rows.append(mine)
        times.append(elapsed)
        events.append(np.full(len(mine), len(weights) - 1))
        resting.append(zero)
    if not weights or not np.any(weights):
        return None
    return Aligned(
        np.concatenate(rows), np.concatenate(times), np.concatenate(events), np.concatenate(resting), np.array(weights)
    )


def corners(evidence: Evidence) -> NDArray[np.int64]:
    """Return the rows of blocks at which a ramp begins or ends."""
    rate, block = evidence.rate, evidence.state.problem.block
    reach = max(1, round(60.0 / block))
    fast = float(np.quantile(np.abs(rate), 0.95))
    found: list[int] = []
    for rows in evidence.runs:
        own = rate[rows]
        if len(own) <= 2 * reach:
            continue
        change = np.abs(own[2 * reach :] - own[: -2 * reach])
        while change.size and change.max() > CORNER * fast > 0.0:
            peak = int(np.argmax(change))
            around = np.arange(max(0, peak - reach), min(peak + reach + 1, len(change)))
            # The middle of what is about as large: the change of a smoothed rate has a flat top.
            middle = round(float(np.average(around, weights=change[around] ** 2)))
            found.append(int(rows[reach + middle]))
            width = round(APART / block)
            change[max(0, peak - width) : peak + width + 1] = 0.0
    return np.array(sorted(found), dtype=np.int64)


def soaks(evidence: Evidence, shortest: float) -> tuple[NDArray[np.int64], float]:
    """Return the rows at which soaks of at least ``shortest`` s begin, and the length of the longest, s."""
    still = np.abs(evidence.rate) < still_rate(evidence.rate)
    starts, longest = [], 0.0
    for rows in evidence.runs:
        edges = np.flatnonzero(np.diff(still[rows].astype(int), prepend=0, append=0))
        for first, last in zip(edges[::2], edges[1::2], strict=True):
            length = float(evidence.seconds[rows[last - 1]] - evidence.seconds[rows[first]])
            if length >= shortest:
                starts.append(int(rows[first]))
                longest = max(longest, length)
    return np.array(starts, dtype=np.int64), longest
