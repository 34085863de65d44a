"""Recordings of any length in bounded memory: long ones as means of a few samples each."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from pathlib import Path

import numpy as np

from hgma_compensation.channels import CHANNELS
from hgma_compensation.coverage.samples import SampleSurvey
from hgma_compensation.progress import Advance
from hgma_compensation.recording.bag_reader import bulk_messages, open_bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.reading import decoder
from hgma_compensation.recording.recording import Recording, Series
from hgma_compensation.recording.slow_inputs import read_slow
from hgma_compensation.recording.streamed import StreamedRecording, Window, open_recording
from hgma_compensation.topics import TopicNames

MOST = 1 << 20
"""Samples of the accelerometer that are judged one by one; of more, means of a few."""


@dataclass(frozen=True)
class Reading:
    """recording: to be judged. survey: of all its samples. averaged: samples in each that the recording has."""

    recording: Recording
    survey: SampleSurvey
    averaged: int = 1


def read(path: Path, names: TopicNames, span: tuple[float | None, float | None], progress: Advance | None) -> Reading:
    """Return the part of a bag from span[0] to before span[1], in s from its start, None for all.

    What it takes of memory grows with the thermometers' samples only, beyond MOST samples of the accelerometer.
    """
    return reading_of(open_recording(path, names, progress).cut(*span))


def reading_of(source: Recording | StreamedRecording, most: int = MOST) -> Reading:
    """Return a recording, and what its samples are; one of more than ``most`` samples left in its bag is averaged."""
    survey = SampleSurvey()
    if isinstance(source, Recording):
        survey.add(source.stamps, source.values)
        return Reading(source, survey)
    count = ceil(source.samples / most)
    windows = list(_averaged(source.windows(), count, survey))
    slow = _slow_inputs(source)
    recording = Recording(
        name=source.name,
        stamps=np.concatenate([stamps for stamps, _ in windows]),
        values=np.concatenate([values for _, values in windows]),
        present=source.present,
        temperature=source.temperature,
        temperature_2=slow["temperature_2"].between(*source.span),
        supply_voltage=slow["supply_voltage"].between(*source.span),
        frame=source.frame,
    )
    return Reading(recording, survey, count)


def _averaged(windows: Iterator[Window], count: int, survey: SampleSurvey) -> Iterator[Window]:
    """Yield the means of ``count`` samples after each other; what is left at the end is left out."""
    kept: Window = (np.empty(0, dtype=np.int64), np.empty((0, len(CHANNELS))))
    for stamps, values in windows:
        survey.add(stamps, values)
        stamps, values = np.concatenate([kept[0], stamps]), np.concatenate([kept[1], values])
        whole = len(stamps) // count
        kept = stamps[whole * count :], values[whole * count :]
        grid = stamps[: whole * count].reshape(whole, count)
        # Offsets from the first: the sum of a few stamps in ns would not fit into 64 bits.
        middle = grid[:, 0] + (grid - grid[:, :1]).mean(axis=1).astype(np.int64) if whole else grid.reshape(-1)
        yield middle, values[: whole * count].reshape(whole, count, -1).mean(axis=1)


def _slow_inputs(source: StreamedRecording) -> dict[str, Series]:
    """Return the thermometers and the supply voltage of a recording that is left in its bag, as fields are named."""
    series = {}
    with open_bag(source.path) as bag:
        for slow, connections in BagTopics(bag, source.path, source.names).slow:
            parts = [Series.empty()]
            if connections:
                decode = decoder(bag, source.path, connections[0])
                parts += [read_slow(batch, slow, decode) for batch in bulk_messages(bag, source.path, connections)]
            series[slow.series] = Series(
                *(np.concatenate([getattr(part, name) for part in parts]) for name in ("stamps", "values"))
            )
    return series
