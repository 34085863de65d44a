"""Sums over the shocks that a sensor has had."""

from dataclasses import dataclass, fields
from math import isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.effects.running_sums import Sums
from hgma_compensation.effects.sample_times import GAP, NEVER, factors, put_halves, seconds_before
from hgma_compensation.kalman.low_pass import low_pass, low_pass_step
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]

FEWEST = 32
"""Samples from which on many quiet ones at once take less time than one by one."""

FIRST_PART, LONGEST_PART = 64, 16384
"""Quiet samples after which more are expected, and most at once: what is computed beyond the next shock is lost."""


_COUNT = len(fields(Sums))


class _Samples(NamedTuple):
    """Of n samples: s since the one before, factor of the decay, what the level keeps, acceleration."""

    seconds: Array
    decays: Array
    keeps: Array
    values: Array

    def part(self, start: int, stop: int) -> "_Samples":
        rows = slice(start, stop)
        return _Samples(self.seconds[rows], self.decays[rows], self.keeps[rows], self.values[rows])


@dataclass(frozen=True)
class ShockSums:
    """Sum of the signed peaks of all shocks, and the same with each of them decaying from its peak on.

    Samples that differ from the level of the quiet ones by more than the threshold, within MERGE seconds of each
    other, are one shock; its peak is the difference largest in magnitude. Differences that last for LASTING seconds
    without a break are a new level. The state ends with the s and ns of the last stamp.
    """

    threshold: float
    time_constant: float

    MERGE, LASTING, LEVEL_TIME = 1.0, 3.0, 1.0

    @property
    def size(self) -> int:
        """Return the size of the state."""
        return _COUNT + 2

    def start(self) -> Array:
        """Return the state of a sensor that has seen no shock."""
        return np.array([0.0] * _COUNT + [NEVER, 0.0])

    def run(self, state: Array, stamps: Stamps, acceleration: Array) -> Array:
        """Return the states (n, 9) after each sample; no bit differs however the samples are split."""
        seconds = np.maximum(seconds_before(state[-2:], stamps), 0.0)
        decays, keeps = np.exp(seconds / -self.time_constant), 1.0 + np.expm1(seconds / -self.LEVEL_TIME)
        samples = _Samples(seconds, decays, keeps, acceleration)
        states = np.empty((len(stamps), self.size))
        if 0 < len(states) < FEWEST:
            self._pass_singly(state, samples, states)
        else:
            self._pass(state, samples, states)
        put_halves(states, stamps)
        return states

    def raised(self, state: Array, by: float) -> Array:
        """Return the state (9,) of a sensor that showed ``by`` more in all samples so far."""
        sums = Sums(*state[:-2].tolist())
        sums.level += by
        return np.array([*vars(sums).values(), *state[-2:].tolist()])

    def _pass(self, state: Array, samples: _Samples, states: Array) -> None:
        """Write the sums after each sample into states (n, 9): quiet ones many at once, about shocks one by one."""
        done, count, length, singly = 0, len(states), LONGEST_PART, FIRST_PART
        while done < count:
            stop = min(done + length, count)
            taken = self._pass_quiet(state, samples.part(done, stop), states[done:stop])
            done += taken
            if done == stop:
                state, length = states[done - 1], min(2 * length, LONGEST_PART)
                continue
            # Where shocks are so frequent that many at once is a loss, it is tried less and less often.
            singly = FIRST_PART if taken >= FEWEST else min(2 * singly, LONGEST_PART)
            state, stop = states[done - 1] if done else state, min(done + singly, count)
            self._pass_singly(state, samples.part(done, stop), states[done:stop])
            done, state, length = stop, states[stop - 1], FIRST_PART

    def _pass_quiet(self, state: Array, samples: _Samples, states: Array) -> int:
        """Write the sums after the samples before the first that is beyond the threshold; return how many those are."""
        permanent, decaying, peak, remainder, quiet, above, level = state[:_COUNT].tolist()
        finite, after_gap = np.isfinite(samples.values), samples.seconds > GAP
        # After a gap the level is that of the sample; one that is not finite says nothing of it.
        keeps = np.where(finite, np.where(after_gap, 0.0, samples.keeps), 1.0)
        values = np.where(finite, samples.values, 0.0)
        levels = low_pass(level, factors(keeps), values)
        within = (np.abs(values - levels[:-1]) <= self.threshold) | after_gap | ~finite
        count = len(within) if within.all() else int(np.argmin(within))
        seconds, decays = samples.seconds[:count], samples.decays[:count]
        quiets, aboves = (np.add.accumulate(np.concatenate([[start], seconds])) for start in (quiet, above))
        over = quiets[1:] > self.MERGE
        columns = (
            permanent,
            _products(decaying, decays),
            np.where(over, 0.0, peak),
            np.where(over, 0.0, _products(remainder, decays)),
            quiets[1:],
            np.where(quiets[:-1] == 0.0, aboves[1:], 0.0),
            levels[1 : count + 1],
        )
        for place, column in enumerate(columns):
            states[:count, place] = column
        return count

    def _pass_singly(self, state: Array, samples: _Samples, states: Array) -> None:
        """Write the sums after each sample."""
        sums = Sums(*state[:_COUNT].tolist())
        each = zip(*(column.tolist() for column in samples), strict=True)
        rows = []
        for seconds, decay, keep, value in each:
            sums.pass_time(seconds, decay, self.MERGE)
            if isfinite(value):
                self._take(sums, seconds, keep, value)
            rows.append((*vars(sums).values(),))
        states[:, :_COUNT] = rows

    def _take(self, sums: Sums, seconds: float, keep: float, value: float) -> None:
        difference = value - sums.level
        if seconds > GAP:
            sums.level = value
        elif abs(difference) <= self.threshold:
            sums.level = low_pass_step(sums.level, keep, value)
        else:
            self._stand_out(sums, difference, value)

    def _stand_out(self, sums: Sums, difference: float, value: float) -> None:
        sums.quiet = 0.0
        if sums.above > self.LASTING:
            # A shock may have moved the level: it then stands out from the new one too.
            if abs(sums.peak - difference) <= self.threshold:
                sums.set_peak(0.0)
            sums.level = value
        elif abs(difference) > abs(sums.peak):
            sums.set_peak(difference)


def _products(start: float, factors_in_order: Array) -> Array:
    return np.multiply.accumulate(np.concatenate([[start], factors_in_order]))[1:]
