"""Writes a bag again with the compensated topics beside the recorded ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rosbags.interfaces import Connection

from hgma_compensation import topics
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.kept_memory import keep_memory
from hgma_compensation.pipeline.state_rate import DEFAULT_RATE, StateRate
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_reader import open_bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.bag_writer import BagWriter, Storage, new_bag
from hgma_compensation.recording.batch import Batch
from hgma_compensation.recording.compensation import Made
from hgma_compensation.recording.offline_run import OfflineRun
from hgma_compensation.recording.state_rows import StateRows


@dataclass
class Copied:
    """What became of the accelerometer's samples."""

    samples: int = 0
    compensated: int = 0
    outside_range: int = 0


def write_compensated(
    source: Path,
    calibration: Calibration,
    path: Path,
    *,
    names: topics.TopicNames,
    storage: Storage = Storage.MCAP,
    state_rate: float = DEFAULT_RATE,
    progress: Callable[[int, int], None] | None = None,
) -> Copied:
    """Write the bag ``source`` with the output topics of the node added; those that it has already are replaced.

    state_rate: states in a second of stamps at the most, besides those of change; 0 for one with every message.
    progress: told how many messages were copied since it was told before, and how many there are. Raises RefusedError
    where the bag lacks what the calibration needs.
    """
    keep_memory()
    outputs = {topics.in_bag(topic) for topic in topics.OUTPUTS}
    with open_bag(source) as reader:
        found = BagTopics(reader, Path(source), names)
        copied = [connection for connection in reader.connections if connection.topic not in outputs]
        run = OfflineRun(reader, Path(source), found, calibration, copied)
        with new_bag(path, storage) as bag:
            copies = [bag.copy_topic(connection) for connection in copied]
            writing = _Outputs(bag, calibration, state_rate, blocks=found.blocks)
            for batch, made in run.outputs():
                writing.take(copies, batch, made)
                if progress is not None:
                    progress(len(batch), reader.message_count)
            run.check()
    writing.figures.samples = run.samples
    return writing.figures


class _Outputs:
    """The compensated topic and the states."""

    def __init__(self, bag: BagWriter, calibration: Calibration, rate: float, *, blocks: bool) -> None:
        self._bag, self._calibration, self._rate = bag, calibration, StateRate(rate)
        topic, kind = (topics.COMPENSATED_BLOCK, types.ACCEL_BLOCK) if blocks else (topics.COMPENSATED, types.IMU)
        self._output = bag.topic(topics.in_bag(topic), kind)
        self._state = bag.topic(topics.in_bag(topics.STATE), types.STATE)
        self._layouts: dict[str, StateRows] = {}
        self.figures = Copied()

    def take(self, copies: list[Connection], batch: Batch, made: list[Made]) -> None:
        """Write messages as they are, and what the pipeline made of those of the accelerometer among them."""
        self._bag.write_batch(copies, batch)
        for part in made:
            self.figures.compensated += part.compensated
            self.figures.outside_range += part.outside_range
            self._bag.write_batch([self._output], part.outputs(self._calibration.names))
            ends = part.ends()
            chosen = self._rate.choose(ends.stamps, ends.status, ends.inside)
            for states in part.states(chosen, self._layout):
                self._bag.write_batch([self._state], states)

    def _layout(self, frame: str) -> StateRows:
        """Return the states of accelerations of a frame, of which there is mostly one."""
        if frame not in self._layouts:
            self._layouts = {frame: StateRows(self._calibration, frame)}
        return self._layouts[frame]
