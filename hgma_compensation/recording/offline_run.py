"""Runs the pipeline over a bag from beginning to end, in memory that does not depend on its length."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.calibration.effect_encoding import LARGEST_ACCELERATION
from hgma_compensation.channels import AXES, CHANNELS, group_of
from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.pipeline import Pipeline
from hgma_compensation.pipeline.screening import usable_samples
from hgma_compensation.recording.accelerations import BlockMessages, ImuMessages
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.bag_reader import bulk_messages
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.batch import Batch, Indices
from hgma_compensation.recording.compensated_bag import check_covered
from hgma_compensation.recording.compensation import Compensation, Made
from hgma_compensation.recording.look_ahead import Held, Slow, behind, parts
from hgma_compensation.recording.reading import decoder, no_samples
from hgma_compensation.recording.recording import Series, no_thermistor
from hgma_compensation.recording.slow_inputs import read_slow
from hgma_compensation.recording.whole_blocks import WholeBlockReader
from hgma_compensation.stamps import Stamps

LAG = 3600.0
"""s by which the stamps of the accelerometer may lag those of the slow inputs that were read before it."""

PIECE = 480 << 10
"""Bytes of blocks that are compensated at once, about: few enough for the pipeline to have no results to join."""


class OfflineRun:
    """One calibration over one open bag; what was seen of the bag is told by the attributes that a Recording has too.

    samples: of the accelerometer so far.
    """

    def __init__(
        self,
        bag: Bag,
        path: Path,
        found: BagTopics,
        calibration: Calibration,
        connections: list[Connection],
        span: tuple[int, int] | None = None,
    ) -> None:
        """Take the topics to read, those of ``found`` and any others, and the stamps [first, last) in ns that count."""
        self.name = path.name
        self._bag, self._path, self._found, self._calibration = bag, path, found, calibration
        self._connections, self._span = connections, span
        numbers = {connection.id: number for number, connection in enumerate(connections)}
        self._fast = self._among([numbers[c.id] for c in found.accelerometer])
        self._slow = [(slow, self._among([numbers[c.id] for c in own])) for slow, own in found.slow if own]
        self._pipeline = Pipeline(calibration, lag=LAG)
        self._whole = WholeBlockReader(self._pipeline)
        self.samples = 0
        self._decoders = [decoder(bag, path, connection) for connection in connections]
        self._has: set[str] = set()
        self._thermistor = False
        self._not_zero = np.zeros(len(CHANNELS), dtype=np.bool_)
        self._carried: set[str] = set()

    def _among(self, numbers: list[int]) -> NDArray[np.bool_]:
        """Return for each connection that is read whether it is one of these."""
        among = np.zeros(len(self._connections), dtype=np.bool_)
        among[numbers] = True
        return among

    def windows(self) -> Iterator[tuple[Batch, Compensation | None]]:
        """Yield all messages, and what became of those of the accelerometer among them; ``check`` after the last.

        Raises RefusedError where there is no thermistor.
        """
        for held in self._held():
            for batch in self._pieces(held):
                own = self._accelerations(batch)
                yield batch, self._compensated(own) if len(own) else None

    def outputs(self) -> Iterator[tuple[Batch, list[Made]]]:
        """Yield the same to be written, with blocks taken as wholes where that makes no difference."""
        for held in self._held():
            yield held, list(self._made(self._accelerations(held)))

    def _held(self) -> Iterator[Batch]:
        if not any(slow.need is None for slow, _ in self._slow):
            raise no_thermistor(self.name)
        yield from behind(self._parts(), self)

    def _accelerations(self, batch: Batch) -> Batch:
        """Return the messages of the accelerometer."""
        return batch.select(np.flatnonzero(self._fast[batch.topics]))

    def _made(self, own: Batch) -> Iterator[Made]:
        """Yield what becomes of messages of the accelerometer."""
        while len(own):
            whole = self._whole.take(own) if self._found.blocks and self._span is None else None
            if whole is None:
                piece = next(self._pieces(own))
                own = own.select(slice(len(piece), None))
                made = self._compensated(piece)
                if isinstance(made.messages, BlockMessages):
                    self._whole.learn(made.messages)
                if len(made.usable):
                    yield made
            else:
                own = own.select(slice(len(whole.messages), None))
                self.samples += whole.compensated
                self._not_zero[: len(AXES)] |= self._whole.not_zero
                yield whole

    def check(self) -> None:
        """Raise RefusedError where the bag, read to its end, lacks what the calibration needs."""
        if not self.samples:
            raise no_samples(self._path, self._found)
        check_covered(self, self._calibration)

    @property
    def present(self) -> tuple[str, ...]:
        """The channels that carry something, as far as the bag was read."""
        return tuple(c for n, c in enumerate(CHANNELS) if self._not_zero[n] and group_of(c) in self._carried)

    def require_temperature(self) -> None:
        """Raise RefusedError where there was no thermistor sample."""
        if not self._thermistor:
            raise no_thermistor(self.name)

    def has(self, name: str) -> bool:
        """Return whether there was a finite sample of a slow input, named as the field of Recording."""
        return name in self._has

    def _parts(self) -> Iterator[Held]:
        last: dict[Need | None, int] = {}
        for batch in bulk_messages(self._bag, self._path, self._connections):
            slow = []
            for one, own in self._slow:
                rows = np.flatnonzero(own[batch.topics])
                if len(rows):
                    series = read_slow(batch.select(rows), one, self._decoders[int(batch.topics[rows[0]])])
                    inside = self._inside(series.stamps)
                    series, rows = Series(series.stamps[inside], series.values[inside]), rows[inside]
                if len(rows):
                    slow.append(Slow(one.need, series, rows))
            yield from parts(batch, slow, last)

    def _pieces(self, batch: Batch) -> Iterator[Batch]:
        """Yield a batch, of blocks in pieces of a bounded size."""
        edges = [0, len(batch)]
        if self._found.blocks and batch.size > PIECE:
            ends = np.cumsum(batch.sizes)
            edges[1:1] = (np.flatnonzero(np.diff(ends // PIECE)) + 1).tolist()
        for start, stop in pairwise(edges):
            yield batch.select(slice(start, stop)) if len(edges) > 2 else batch

    def _inside(self, stamps: Stamps) -> NDArray[np.bool_]:
        """Return which samples (n,) count."""
        if self._span is None:
            return np.ones(len(stamps), dtype=np.bool_)
        return np.asarray((stamps >= self._span[0]) & (stamps < self._span[1]))

    def sets_back(self, part: Held) -> bool:
        """Return whether the first of the slow samples of a part moves those before it to a corrected clock."""
        return any(self._pipeline.sets_back(slow.need, int(slow.series.stamps[0])) for slow in part.slow)

    def take(self, part: Held) -> None:
        """Take the slow samples of a part."""
        for slow in part.slow:
            for stamp, value in zip(slow.series.stamps.tolist(), slow.series.values.tolist(), strict=True):
                self._pipeline.add(slow.need, stamp, value)
            self._thermistor = self._thermistor or slow.need is None
            if slow.need is not None and np.isfinite(slow.series.values).any():
                self._has.add(slow.need.value)

    def _compensated(self, own: Batch) -> Compensation:
        """Compensate messages of the accelerometer, of which there is one at least, sample by sample."""
        decode = self._decoders[int(own.topics[0])]
        source = f"bag {self._path}"
        messages = BlockMessages(own, decode, source) if self._found.blocks else ImuMessages(own, decode)
        values, inside = messages.values, self._inside(messages.stamps)
        self.samples += int(np.count_nonzero(inside))
        self._carried |= messages.carried
        for column in np.flatnonzero(~self._not_zero).tolist():
            self._not_zero[column] = bool(values[:, column].any())
        usable, samples = _usable(messages, inside, _screened(messages.stamps, values[:, self._pipeline.columns.read]))
        stamps = messages.stamps
        if len(samples) < len(values):
            stamps, values = stamps[samples], values[samples]
        result = self._pipeline.compensate(stamps, self._pipeline.columns.of(values), values)
        return Compensation(messages, own.times, usable, samples, result)


def _screened(stamps: Stamps, values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (n,) whether samples are usable, which mostly all are: the extremes are found without another array."""
    # Comparisons are false for NaN, which is the extreme of whatever it is among.
    if (
        len(stamps)
        and stamps.min() > 0
        and values.min() >= -LARGEST_ACCELERATION
        and values.max() <= LARGEST_ACCELERATION
    ):
        return np.ones(len(stamps), dtype=np.bool_)
    return usable_samples(stamps, values)


def _usable(
    messages: ImuMessages | BlockMessages, inside: NDArray[np.bool_], usable: NDArray[np.bool_]
) -> tuple[Indices, Indices]:
    """Return the messages that have samples that count, all of them usable, and these samples."""
    if isinstance(messages, ImuMessages):
        rows = np.flatnonzero(inside & usable)
        return rows, rows
    if inside.all() and usable.all():
        return np.flatnonzero(messages.counts), np.arange(len(usable))
    message = np.repeat(np.arange(len(messages.counts)), messages.counts)
    good = np.bincount(message[inside], minlength=len(messages.counts)) > 0
    good[message[inside & ~usable]] = False
    return np.flatnonzero(good), np.flatnonzero(inside & good[message])
