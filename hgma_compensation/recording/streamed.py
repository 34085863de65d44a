"""A recording whose accelerations stay in the bag, for what needs them only once and in their order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hgma_compensation import topics
from hgma_compensation.channels import CHANNELS, GROUPS, group_of
from hgma_compensation.progress import Advance
from hgma_compensation.recording.accelerations import BlockMessages, ImuMessages
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.bag_reader import bulk_messages, open_bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.reading import decoder, no_samples
from hgma_compensation.recording.recording import Extent, Series, no_thermistor
from hgma_compensation.recording.slow_inputs import SLOW_INPUTS, read_slow
from hgma_compensation.stamps import NANOSECONDS, Stamps

Window = tuple[Stamps, NDArray[np.float64]]
"""Stamps (n,) in ns and values (n, 6), columns CHANNELS."""

EVER = (np.iinfo(np.int64).min, np.iinfo(np.int64).max)


@dataclass(frozen=True)
class StreamedRecording:
    """One run of one sensor; the attributes are those of Recording.

    samples: of the accelerometer. span: stamps [first, last) in ns that count.
    """

    name: str
    path: Path
    names: topics.TopicNames
    present: tuple[str, ...]
    temperature: Series
    frame: str
    start: int
    duration: float
    samples: int
    span: tuple[int, int] = EVER

    def require_temperature(self) -> None:
        """Raise RefusedError where there is no thermistor in the recording."""
        if not len(self.temperature.stamps):
            raise no_thermistor(self.name)

    def windows(self) -> Iterator[Window]:
        """Yield the samples of the accelerometer, reading the bag again."""
        with open_bag(self.path) as bag:
            found = BagTopics(bag, self.path, self.names)
            for messages in accelerations(bag, self.path, found):
                inside = (messages.stamps >= self.span[0]) & (messages.stamps < self.span[1])
                yield messages.stamps[inside], messages.values[inside]

    def cut(self, start: float | None, end: float | None, progress: Advance | None = None) -> StreamedRecording:
        """Return the part from start to before end, in s from the start of the recording, reading the bag again.

        Raises RefusedError where nothing is left.
        """
        if start is None and end is None:
            return self
        extent = Extent(self.name, self.start, self.duration)
        span = extent.span(start, end)
        part = survey(self.path, self.names, progress, span)
        if part is None:
            raise extent.nothing_left(start, end)
        return replace(part, present=self.present, frame=self.frame)


def open_recording(path: Path, names: topics.TopicNames, progress: Advance | None) -> StreamedRecording:
    """Return a bag as a recording, having read it once; raises RefusedError where it holds no sample."""
    whole = survey(Path(path), names, progress)
    if whole is None:
        with open_bag(path) as bag:
            raise no_samples(Path(path), BagTopics(bag, Path(path), names))
    return whole


def accelerations(
    bag: Bag, path: Path, found: BagTopics, progress: Advance | None = None
) -> Iterator[ImuMessages | BlockMessages]:
    """Yield the messages of the accelerometer of an open bag."""
    decode = decoder(bag, path, found.accelerometer[0])
    for batch in bulk_messages(bag, path, found.accelerometer):
        yield BlockMessages(batch, decode, f"bag {path}") if found.blocks else ImuMessages(batch, decode)
        if progress is not None:
            progress(len(batch))


def survey(
    path: Path, names: topics.TopicNames, progress: Advance | None = None, span: tuple[int, int] = EVER
) -> StreamedRecording | None:
    """Read a bag once and return what is to be known of it beforehand, None where no sample is in the span."""
    with open_bag(path) as bag:
        found = BagTopics(bag, path, names)
        first, last, count, frame = EVER[1], EVER[0], 0, ""
        not_zero, carried = np.zeros(len(CHANNELS), dtype=np.bool_), set[str]()
        for messages in accelerations(bag, path, found, progress):
            stamps = messages.stamps[(messages.stamps >= span[0]) & (messages.stamps < span[1])]
            not_zero |= (messages.values != 0.0).any(axis=0)
            carried |= messages.carried & set(GROUPS)
            frame = messages.frames(np.array([len(messages.counts) - 1]))[0][1]
            if len(stamps):
                first, last, count = min(first, int(stamps.min())), max(last, int(stamps.max())), count + len(stamps)
        temperature = _temperature(bag, path, found).between(*span)
    if not count:
        return None
    return StreamedRecording(
        name=path.name,
        path=path,
        names=names,
        present=tuple(c for n, c in enumerate(CHANNELS) if not_zero[n] and group_of(c) in carried),
        temperature=temperature,
        frame=frame,
        start=min(first, int(temperature.stamps.min(initial=first))),
        duration=(last - first) / NANOSECONDS,
        samples=count,
        span=span,
    )


def _temperature(bag: Bag, path: Path, found: BagTopics) -> Series:
    connections = found.slow[0][1]
    parts = [Series.empty()]
    if connections:
        decode = decoder(bag, path, connections[0])
        parts += [read_slow(batch, SLOW_INPUTS[0], decode) for batch in bulk_messages(bag, path, connections)]
    return Series(*(np.concatenate([getattr(part, name) for part in parts]) for name in ("stamps", "values")))
