"""The Kalman stage of one channel, for a stream in parts of any length."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.kalman.consistency import Consistency
from hgma_compensation.kalman.gated import GatedFilter
from hgma_compensation.kalman.gated_bulk import pass_closed, pass_open
from hgma_compensation.kalman.intervals import Intervals, Steps
from hgma_compensation.kalman.settings import FilterSettings
from hgma_compensation.stamps import Stamps

Array = NDArray[np.float64]

FEWEST = 32
"""Samples from which on many at once take less time than one by one."""

FIRST_PART, LONGEST_PART = 64, 32768
"""Samples at once after the gate has moved, and when it has not for long: what is computed beyond a move is lost."""


class KalmanStage:
    """Streaming stage: however the samples are split over calls, no bit of the result differs."""

    def __init__(self, settings: FilterSettings, reference: float) -> None:
        """Take the settings of a channel whose mode is not OFF, and its still value (BIAS: bias = 0 there)."""
        self._filter = GatedFilter(settings, reference)
        self._intervals = Intervals()
        self._part = FIRST_PART

    def reset(self) -> None:
        """Forget every sample; the number of openings stays."""
        self._filter.reset()
        self._intervals.reset()

    @property
    def open(self) -> bool:
        """Whether real acceleration is passing as it is."""
        return self._filter.open

    @property
    def openings(self) -> int:
        """How often real acceleration has opened the gate."""
        return self._filter.openings

    def set_back(self, stamp: int) -> None:
        """Go on at a clock that was set back, the next sample's being ``stamp`` (ns): that one has no interval."""
        self._intervals.newest = stamp

    def take_consistency(self) -> Consistency:
        """Return what the innovations were like since the last call."""
        taken, self._filter.consistency = self._filter.consistency, Consistency()
        return taken

    def run(self, stamps: Stamps, measured: Array) -> tuple[Array, Array]:
        """Return outputs and innovations, each (n,), of finite measurements (n,) at stamps (ns).

        A sample whose stamp does not exceed all before it has no interval, hence no known noise: it passes
        under the estimate there is, and corrects nothing.
        """
        outputs, innovations = np.empty(len(stamps)), np.empty(len(stamps))
        done = 0
        if len(stamps) and not self._filter.level.started:
            self._intervals.newest = int(stamps[0])
            self._filter.start(float(measured[0]))
            # The first has no interval and the second sets it: what follows may be even.
            done = min(2, len(stamps))
            self._run_few(stamps[:done], measured[:done], outputs, innovations)
        while done < len(stamps):
            part = slice(done, done + LONGEST_PART)
            run = self._run_many if len(stamps[part]) >= FEWEST else self._run_few
            run(stamps[part], measured[part], outputs[part], innovations[part])
            done += LONGEST_PART
        return outputs, innovations

    def _run_few(self, stamps: Stamps, measured: Array, outputs: Array, innovations: Array) -> None:
        """Fill in outputs and innovations of samples (n,), one by one."""
        take, step = self._filter.step, self._intervals.step
        for k, (stamp, z) in enumerate(zip(stamps.tolist(), measured.tolist(), strict=True)):
            outputs[k], innovations[k] = take(*step(stamp), z)

    def _run_many(self, stamps: Stamps, measured: Array, outputs: Array, innovations: Array) -> None:
        """Do so in parts in which the gate does not move and every sample has an interval."""
        with np.errstate(over="ignore", invalid="ignore"):
            samples = np.ascontiguousarray(measured, dtype=np.float64)
            self._run_parts(self._intervals.steps(stamps), samples, outputs, innovations)

    def _run_parts(self, steps: Steps, samples: Array, outputs: Array, innovations: Array) -> None:
        stage, count = self._filter, len(samples)
        late = deque(() if isinstance(steps.dt, float) else np.flatnonzero(steps.dt <= 0.0).tolist())
        done = 0
        while done < count:
            stop = late[0] if late else count
            wanted = min(self._part, stop - done)
            if wanted >= FEWEST and stage.level.variance is not None:
                pass_samples = pass_open if stage.open else pass_closed
                passed = pass_samples(stage, steps.part(done, done + wanted), samples[done : done + wanted])
                part = slice(done, done + len(passed.outputs))
                outputs[part], innovations[part] = passed
                done = part.stop
                self._part = min(2 * self._part, LONGEST_PART) if len(passed.outputs) == wanted else FIRST_PART
                if len(passed.outputs) == wanted:
                    continue
            if done == stop:
                late.popleft()
            outputs[done], innovations[done] = stage.step(*steps.at(done), float(samples[done]))
            done += 1
