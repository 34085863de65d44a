"""Notices that a calibration no longer fits its sensor, from what is left of the acceleration at rest.

Judged over means of 5 s, as the calibration's own error is. Two ways of being wrong show at rest:
the residual moves while the temperature does, or its level is off by more than any tilt of the sensor explains.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration
from hgma_compensation.channels import GROUPS, group_of
from hgma_compensation.pipeline.ordinary_block import BlockSums
from hgma_compensation.pipeline.screening import sum_of_squares
from hgma_compensation.stamps import Stamps, to_nanoseconds

Array = NDArray[np.float64]

BLOCK = to_nanoseconds(5.0)
WINDOW = 720
"""Blocks that are judged at most: an hour."""

CALM = 3.0
"""Times the noise that a block's samples scatter at rest at the most."""

STEP = 6.0
"""Standard deviations between two blocks that are a new position, not drift."""

LEAST_BLOCKS, LEAST_CELSIUS = 24, 2.0
"""At rest in one position, with that change of the temperature, before the residual is judged: 2 min."""

WORSE = 3.0
"""Times its own error that a calibration may show."""

TILT = {GROUPS[0]: 2.0 * 9.80665, GROUPS[1]: 0.0}
"""Change of the level at rest by turning the sensor over, m/s² and rad/s."""


@dataclass(frozen=True)
class Residual:
    """What one channel shows at rest. rms: about its mean. own: the calibration's error; all in the channel's unit."""

    channel: str
    level: float
    rms: float
    own: float
    fits: bool


class Temperatures(Protocol):
    """Where the temperature of samples is found, in °C."""

    @property
    def features(self) -> Array:
        """(n, 3), the temperature first."""
        ...


class RestMonitor:
    """Follows the output of the drift model; the Kalman stage would hide what it looks for."""

    def __init__(self, calibration: Calibration) -> None:
        """Take the errors that the calibration knows of itself."""
        self._channels = calibration.channels
        self._references = [channel.reference for channel in self._channels]
        self._noise = np.array([channel.error.noise for channel in self._channels])
        self._own = np.array([channel.error.unseen for channel in self._channels])
        self._means: deque[Array] = deque(maxlen=WINDOW)
        self._temperatures: deque[float] = deque(maxlen=WINDOW)
        self._begin(0)

    def reset(self) -> None:
        """Forget all samples."""
        self._leave()
        self._begin(0)

    def take(self, stamps: Stamps, corrected: Array, at: Temperatures, usable: bool) -> None:
        """Take samples less their drift (n, c) at stamps (n,) in ns, with the temperature.

        usable: whether the temperature was what the calibration knows; what is not is not judged.
        """
        first, last = int(stamps[0]), int(stamps[-1])
        self._turn_to(first, usable)
        if usable:
            self._add(corrected)
            self._close(last, at)

    def take_sums(self, first: int, last: int, sums: BlockSums, at: Temperatures) -> None:
        """Take samples from ``first`` to ``last`` (ns) by their sums; usable are those without a status."""
        self._turn_to(first, usable=not sums.statuses)
        if not sums.statuses:
            self._add_sums(sums.count, sums.totals, sums.squares)
            self._close(last, at)

    def _turn_to(self, first: int, usable: bool) -> None:
        """Prepare for samples from a stamp (ns) on: is the block before still theirs, and the position?"""
        if usable and 0 <= first - self._start < 2 * BLOCK:
            return
        if not usable or self._count:
            self._leave()
        self._begin(first)

    def _close(self, last: int, at: Temperatures) -> None:
        """End the block if samples up to a stamp (ns) fill it."""
        if last - self._start >= BLOCK:
            self._end_block(float(at.features[-1, 0]))
            self._begin(last)

    def goes_on(self, stamp: int) -> bool:
        """Return whether a sample at a stamp (ns) neither begins nor ends a block."""
        return self._count > 0 and 0 <= stamp - self._start < BLOCK

    def add_one(self, corrected: list[float]) -> None:
        """Take one sample less its drift (c,) that ``goes_on``, with a temperature that the calibration knows."""
        self._count += 1
        for number, reference in enumerate(self._references):
            residual = corrected[number] - reference
            self._sum[number] += residual
            self._squares[number] += residual * residual

    def _add(self, corrected: Array) -> None:
        """Add samples (n, c) to the sums, of their differences from the references and the squares of these."""
        if len(corrected) == 1:
            return self.add_one(corrected[0].tolist())
        columns = corrected.T
        self._add_sums(len(corrected), [float(c.sum()) for c in columns], list(map(sum_of_squares, columns)))

    def _add_sums(self, count: int, totals: Sequence[float], squares: Sequence[float]) -> None:
        self._count += count
        for number, (reference, total) in enumerate(zip(self._references, totals, strict=True)):
            self._sum[number] += total - count * reference
            self._squares[number] += squares[number] - reference * (2.0 * total - count * reference)

    def _begin(self, stamp: int) -> None:
        self._start, self._count = stamp, 0
        self._sum, self._squares = [0.0] * len(self._own), [0.0] * len(self._own)

    def _leave(self) -> None:
        """The sensor has moved, or what it showed cannot be judged: what follows is another position."""
        self._means.clear()
        self._temperatures.clear()

    def _end_block(self, temperature: float) -> None:
        mean = np.array(self._sum) / self._count
        scatter = np.sqrt(np.maximum(np.array(self._squares) / self._count - mean * mean, 0.0))
        if np.any(scatter > CALM * self._noise * np.sqrt(self._count)):
            return self._leave()
        if self._means and np.any(np.abs(mean - self._means[-1]) > STEP * np.sqrt(2.0) * self._own):
            self._leave()
        self._means.append(mean)
        self._temperatures.append(temperature)

    def residuals(self) -> list[Residual]:
        """Return what each channel shows at rest, nothing before there is enough to judge."""
        if len(self._means) < LEAST_BLOCKS:
            return []
        means = np.array(self._means)
        level = means.mean(axis=0)
        rms = np.sqrt(np.mean((means - level) ** 2, axis=0))
        return [self._judge(*row) for row in zip(self._channels, level.tolist(), rms.tolist(), strict=True)]

    def _judge(self, channel: ChannelCalibration, level: float, rms: float) -> Residual:
        own = channel.error.unseen
        moved = max(self._temperatures) - min(self._temperatures) >= LEAST_CELSIUS
        drifts = moved and rms > WORSE * own
        off = abs(level) > WORSE * own + TILT[group_of(channel.name)]
        return Residual(channel.name, level, rms, own, fits=not (drifts or off))
