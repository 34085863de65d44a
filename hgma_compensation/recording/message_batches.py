"""The messages of any storage in bulk, as ``rosbags`` hands them out one by one."""

from collections.abc import Iterable, Iterator
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag2.storage_mcap import McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from hgma_compensation.recording import decoder_limits
from hgma_compensation.recording.batch import Batch, gathered
from hgma_compensation.recording.mcap_batches import is_plain, mcap_batches

BATCH = 1 << 20
"""Bytes of messages in a batch, about: one chunk of an MCAP file."""

MOST_MESSAGES = 1 << 14
"""Messages in a batch that is put together of single ones."""

Row = tuple[int, int, bytes]
"""Id of the connection in its file, log time in ns, and serialised message."""

_SELECT = (
    "SELECT topics.id,messages.timestamp,messages.data FROM messages JOIN topics ON messages.topic_id=topics.id "
    "WHERE topics.id IN ({}) ORDER BY timestamp"
)
"""The library's own: another one could bring messages of the same time in another order."""


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
            rows = _rows(part, topics)
            if packed:
                rows = ((own, time, decoder_limits.unpack_message(raw)) for own, time, raw in rows)
            for some in _row_lists(rows):
                ids, times, raws = zip(*some, strict=True)
                yield Batch.of_messages([topics[own] for own in ids], times, list(raws))


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


def _rows(part: Any, topics: dict[int, int]) -> Iterator[Row]:
    """Return the messages of the connections whose ids are the keys of ``topics``."""
    if isinstance(part, Sqlite3Reader):
        assert part.dbconn
        # As they come from the database: what the library makes of each costs as much as reading it.
        rows: Iterator[Row] = part.dbconn.execute(_SELECT.format(",".join("?" * len(topics))), tuple(topics))
        return rows
    chosen = [connection for connection in part.connections if connection.id in topics]
    return ((connection.id, time, raw) for connection, time, raw in part.messages(chosen))


def _row_lists(rows: Iterable[Row]) -> Iterator[list[Row]]:
    """Yield rows many at a time."""
    some: list[Row] = []
    size = 0
    for row in rows:
        some.append(row)
        size += len(row[2])
        if size >= BATCH or len(some) >= MOST_MESSAGES:
            yield some
            some, size = [], 0
    if some:
        yield some
