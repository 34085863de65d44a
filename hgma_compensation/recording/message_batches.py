"""The messages of any storage in bulk, as ``rosbags`` hands them out one by one."""

from collections.abc import Iterable, Iterator
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag2.storage_mcap import McapReader

from hgma_compensation.recording import decoder_limits
from hgma_compensation.recording.batch import Batch, gathered
from hgma_compensation.recording.mcap_batches import is_plain, mcap_batches

BATCH = 1 << 20
"""Bytes of messages in a batch, about: one chunk of an MCAP file."""

FEWEST_MESSAGES, MOST_MESSAGES = 256, 1 << 14
"""Messages in a batch that is put together of single ones; of blocks there are too few in BATCH bytes."""

LARGEST = 4 * BATCH
"""Bytes in a batch of fewer messages."""


def batches(storage: Any, connections: list[Connection], *, packed: bool) -> Iterator[Batch]:
    """Yield the messages of some connections of an open storage of ``rosbags``, each topic being its place in them.

    packed: whether each message is compressed by itself. Raises what the library raises where the bag is damaged.
    """
    for part in getattr(storage, "storages", [storage]):
        topics = _topics(part, connections)
        if not topics:
            continue
        if isinstance(part, McapReader) and is_plain(part) and not packed:
            yield from gathered(mcap_batches(part, topics), BATCH // 4)
        else:
            chosen = [connection for connection in part.connections if connection.id in topics]
            yield from _of_single(part.messages(chosen), topics, packed=packed)


def _topics(part: Any, connections: list[Connection]) -> dict[int, int]:
    """Return which of the connections each one of a storage file is, by its id there; the others are left out."""
    if connections and connections[0].owner is part:
        return {connection.id: number for number, connection in enumerate(connections)}
    found = {}
    for own in part.connections:
        # As the library pairs them: a bag of several files numbers its topics in each file anew.
        same = (number for number, wanted in enumerate(connections) if _is_same(own, wanted))
        number = next(same, None)
        if number is not None:
            found[own.id] = number
    return found


def _is_same(own: Connection, wanted: Connection) -> bool:
    digests = (own.digest, wanted.digest)
    return (
        own.topic == wanted.topic
        and own.msgtype == wanted.msgtype
        and own.ext == wanted.ext
        and (not all(digests) or digests[0] == digests[1])
    )


def _of_single(
    messages: Iterable[tuple[Connection, int, bytes]], topics: dict[int, int], *, packed: bool
) -> Iterator[Batch]:
    numbers: list[int] = []
    times: list[int] = []
    raws: list[bytes] = []
    size = 0
    for connection, time, raw in messages:
        data = decoder_limits.unpack_message(raw) if packed else raw
        numbers.append(topics[connection.id])
        times.append(time)
        raws.append(data)
        size += len(data)
        enough = size >= (BATCH if len(raws) >= FEWEST_MESSAGES else LARGEST)
        if enough or len(raws) >= MOST_MESSAGES:
            yield Batch.of_messages(numbers, times, raws)
            numbers, times, raws, size = [], [], [], 0
    if raws:
        yield Batch.of_messages(numbers, times, raws)
