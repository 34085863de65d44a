"""Many samples at once through a GatedFilter, every bit as one by one.

What is sequential is summed in order (np.add.accumulate, lfilter, or a loop over the numbers of the gain while that has
not settled); all else is elementwise.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.course import course
from hgma_compensation.kalman.gate import WINDOW
from hgma_compensation.kalman.gated import GatedFilter
from hgma_compensation.kalman.impulse import LOOK_BACK
from hgma_compensation.kalman.intervals import Steps

Array = NDArray[np.float64]


class Passed(NamedTuple):
    """Outputs and innovations of the first samples, as many as were taken before the gate moves, or after it closed."""

    outputs: Array
    innovations: Array


def pass_closed(stage: GatedFilter, steps: Steps, samples: Array) -> Passed:
    """Take samples while the gate is closed, up to and without the one that opens it."""
    level = stage.level
    found = course(level, steps, samples)
    estimates, variances, innovation_variances = found.estimates, found.variances, found.innovation_variances
    innovations = samples - estimates[:-1]
    normalised = innovations / np.sqrt(innovation_variances)
    count = stage.gate.take_until_exceeded(normalised, innovation_variances)
    samples, innovations, normalised = samples[:count], innovations[:count], normalised[:count]
    dt = steps.part(0, count).dt
    outputs = stage.output(samples, estimates[1 : count + 1])
    found.take(level, count)
    tail = slice(max(count - WINDOW, 0), count)
    before = np.broadcast_to(variances, estimates.shape)[tail]
    stage.history.extend(zip(estimates[tail].tolist(), before.tolist(), strict=True))
    stage.consistency.take_all(normalised)
    newest = slice(max(count - LOOK_BACK, 0), count)
    recent = dt if isinstance(dt, float) else dt[newest]
    stage.debt.withhold_all((samples[newest] - outputs[newest]) * recent)
    return Passed(_paid(stage, dt, normalised, outputs), innovations)


def pass_open(stage: GatedFilter, steps: Steps, samples: Array) -> Passed:
    """Take samples while the gate is open, up to and with the one that closes it."""
    level = stage.level
    assert level.variance is not None
    dt, averaged = steps.each(len(samples))
    variances = np.add.accumulate(np.concatenate([[level.variance], level.added_variance(dt)]))
    sample_variances = level.sample_variance(averaged)
    estimate, count = level.estimate, len(samples)
    outputs = stage.output(samples, np.full(count, estimate))
    for taken, mean, spread in stage.quiet.blocks(samples):
        level.variance, sample_variance = float(variances[taken]), float(sample_variances[taken - 1])
        if stage.quiet.take_block(mean, spread, sample_variance) and stage.close_if_quiet(sample_variance):
            count = taken
            break
    else:
        level.variance = float(variances[count])
    stage.consistency.open += count
    innovations = samples[:count] - estimate
    normalised = innovations / np.sqrt(variances[1:] + sample_variances)[:count]
    return Passed(_paid(stage, dt, normalised, outputs[:count]), innovations)


def _paid(stage: GatedFilter, dt: float | Array, normalised: Array, outputs: Array) -> Array:
    return outputs + stage.debt.pay_all(dt, normalised) if stage.debt.owes else outputs
