"""Accelerometer messages of a bag that were compensated, as what is written of them asks for them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.pipeline.compensated import Compensated
from hgma_compensation.recording.accelerations import BlockMessages, ImuMessages, of_rows
from hgma_compensation.recording.batch import Batch, Indices
from hgma_compensation.recording.state_rows import StateRows
from hgma_compensation.stamps import Stamps

Layout = Callable[[str], StateRows]
"""Returns the states for accelerations of a frame."""


@dataclass(frozen=True)
class Ends:
    """The last sample of each of n messages.

    stamps: (n,) ns. status: (n,) TemperatureStatus. inside: (n,) whether the features lie in the calibrated range.
    """

    stamps: Stamps
    status: NDArray[np.uint8]
    inside: NDArray[np.bool_]


class Made(Protocol):
    """n messages, compensated."""

    @property
    def compensated(self) -> int:
        """Number of samples."""

    @property
    def outside_range(self) -> int:
        """Number of samples whose features lie outside of the calibrated range."""

    def outputs(self, channels: Sequence[str]) -> Batch:
        """Return the compensated messages, of a calibration of these channels, as topic 0."""

    def ends(self) -> Ends:
        """Return what decides which of the messages get a state."""

    def states(self, chosen: Indices, layout: Layout) -> Iterator[Batch]:
        """Yield the states of the last samples of the messages ``chosen`` (m,), increasing, as topic 0."""


@dataclass(frozen=True)
class Compensation:
    """What the pipeline made of accelerometer messages, sample by sample.

    messages: k of them. times: (k,) their log times, ns. usable: (m,) which of them were compensated, as one that is
    not finite costs its whole message. samples: (n,) of the usable messages. result: of these samples.
    """

    messages: ImuMessages | BlockMessages
    times: Stamps
    usable: Indices
    samples: Indices
    result: Compensated

    @property
    def compensated(self) -> int:
        """Number of samples."""
        return len(self.result.values)

    @property
    def outside_range(self) -> int:
        """Number of samples whose features lie outside of the calibrated range."""
        return 0 if self.result.ordinary else int(np.count_nonzero(~self.result.inside_range))

    def outputs(self, channels: Sequence[str]) -> Batch:
        """Return the compensated messages, of a calibration of these channels, as topic 0."""
        return self.messages.compensated(channels, self.usable, self.result)

    def ends(self) -> Ends:
        """Return what decides which of the messages get a state."""
        last = self._last
        stamps = self.messages.stamps[self.samples[last]]
        if self.result.ordinary:
            return Ends(stamps, np.zeros(len(last), dtype=np.uint8), np.ones(len(last), dtype=np.bool_))
        return Ends(stamps, self.result.status[last], self.result.inside_range[last])

    def states(self, chosen: Indices, layout: Layout) -> Iterator[Batch]:
        """Yield the states of the last samples of the messages ``chosen`` (m,), increasing, as topic 0."""
        rows, last = self.usable[chosen], self._last[chosen]
        heads = self.messages.heads(rows)
        for part, frame in self.messages.frames(rows):
            states = layout(frame).rows(heads[part], self.result.take(last[part]))
            yield of_rows(states, self.times[rows[part]])

    @cached_property
    def _last(self) -> Indices:
        """Return the last sample of each usable message among the samples, (m,)."""
        return np.cumsum(self.messages.counts[self.usable]) - 1
