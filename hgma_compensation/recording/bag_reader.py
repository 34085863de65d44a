"""Reads a recording out of a rosbag2 folder or file, MCAP or SQLite."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from rosbags.interfaces import Connection

from hgma_compensation import topics
from hgma_compensation.errors import RefusedError
from hgma_compensation.progress import Advance
from hgma_compensation.recording.bag import Bag
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.batch import Batch
from hgma_compensation.recording.reading import Held, Read, Reading, Samples
from hgma_compensation.recording.recording import Recording


@contextmanager
def open_bag(path: Path) -> Iterator[Bag]:
    """Open a bag; raises RefusedError where it is none, is damaged, or ends too early."""
    path = Path(path)
    if not path.exists():
        raise RefusedError(f"bag {path} does not exist: give a rosbag2 folder or an .mcap or .db3 file")
    if path.is_dir() and not (path / "metadata.yaml").exists():
        raise RefusedError(
            f"bag {path} has no metadata.yaml: if recording was cut off, run ros2 bag reindex {path.name}"
        )
    reader = None
    try:
        reader = Bag(path)
    except RefusedError as refusal:
        raise RefusedError(f"bag {path}: {refusal}") from None
    except Exception as error:  # whatever a parser raises on damaged bytes
        raise RefusedError(f"bag {path} cannot be read ({error}): it is damaged or no rosbag2 recording") from error
    try:
        yield reader
    finally:
        reader.close()


def read_messages(reader: Bag, path: Path, connections: list[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
    """Yield the messages; a damaged storage raises RefusedError instead of the library's error."""
    try:
        yield from reader.messages(connections)
    except Exception as error:  # whatever a parser raises on damaged bytes
        raise RefusedError(f"bag {path} is damaged ({error}): record or copy it again") from error


def bulk_messages(reader: Bag, path: Path, connections: list[Connection]) -> Iterator[Batch]:
    """Yield the messages many at a time, as ``Bag.batches`` does; a damaged storage raises RefusedError."""
    try:
        yield from reader.batches(connections)
    except Exception as error:  # whatever a parser raises on damaged bytes
        raise RefusedError(f"bag {path} is damaged ({error}): record or copy it again") from error


def read_recording(path: Path, names: topics.TopicNames | None = None, progress: Advance | None = None) -> Recording:
    """Return a bag as a recording.

    Accelerations come from the message topic, or from the block topic where there are no messages.
    Raises RefusedError where there is neither, or where a topic has another type.
    """
    read, samples = read_bag(path, names, progress, Held())
    return Recording(
        read.name,
        samples.stamps.array(),
        samples.values.array(),
        read.present,
        frame=read.frame,
        block=samples.block,
        **read.series,
    )


Kept = TypeVar("Kept", bound=Samples)


def read_bag(path: Path, names: topics.TopicNames | None, progress: Advance | None, samples: Kept) -> tuple[Read, Kept]:
    """Read a bag into samples; raises what ``read_recording`` does."""
    with open_bag(path) as reader:
        found = BagTopics(reader, Path(path), names or topics.TopicNames())
        reading = Reading(reader, Path(path), found, samples)
        for batch in bulk_messages(reader, Path(path), found.read):
            reading.take(batch)
            if progress is not None:
                progress(len(batch))
        return reading.read(), samples
