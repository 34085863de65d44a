"""Which part of a sensor's recordings is learned from, and which it is judged on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor
from pathlib import Path

from hgma_compensation.diagnosis.recordings import HELD_OUT
from hgma_compensation.errors import RefusedError
from hgma_compensation.fleet.sensors import holdout_of
from hgma_compensation.recording.recording import Recording
from hgma_compensation.recording.streamed import StreamedRecording, open_recording
from hgma_compensation.topics import TopicNames

Opened = Recording | StreamedRecording


@dataclass(frozen=True)
class Split:
    """training: recordings to learn from, in the order of their names, before ``limit``. judged: bag to judge on.

    limit: s from the start of the only recording, which is judged on from there on; None where the two are apart.
    """

    training: tuple[Opened, ...]
    judged: Path
    limit: float | None = None


def split(recordings: Sequence[Path], pattern: str | None, names: TopicNames) -> Split:
    """Return what to learn from and what to judge on, always apart.

    The recording named for it is judged on; without one the last of several in time, or the end of the only one.
    Raises RefusedError where a recording cannot be read, or the only one is too short to be divided.
    """
    paths = tuple(recordings)
    holdout = holdout_of(paths, pattern)
    opened = [open_recording(path, names, None) for path in paths if path != holdout]
    if holdout is not None:
        return Split(tuple(opened), holdout)
    if len(paths) > 1:
        last = max(range(len(opened)), key=lambda number: opened[number].start)
        return Split(tuple(one for number, one in enumerate(opened) if number != last), paths[last])
    limit = float(floor((1.0 - HELD_OUT) * opened[0].duration))
    if limit <= 0.0:
        raise RefusedError(f"{paths[0].name} lasts {opened[0].duration:.1f} s: too short to hold out a part of it")
    return Split((opened[0].cut(None, limit),), paths[0], limit)
