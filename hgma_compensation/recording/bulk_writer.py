"""A ``rosbags`` writer that takes messages many at a time, and writes them while more are made."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from hgma_compensation.recording.batch import Batch, Indices
from hgma_compensation.recording.in_turn import InTurn
from hgma_compensation.recording.mcap_bulk_writer import BulkMcapWriter

MOST_WAITING = 4
"""Batches that wait to be written: the memory of so many is held."""

MOST_BYTES, MOST_MESSAGES = 1 << 20, 4096
"""Of messages that come one by one, until they are written together."""

ROWS = 300
"""Of a database, inserted by one statement: each takes three of the at least 999 parameters that there can be."""

SETTINGS = ("page_size=32768", "cache_size=-4096", "journal_mode=OFF", "synchronous=OFF", "locking_mode=EXCLUSIVE")
"""Of a database that nobody sees before it is whole, and that is removed where it does not get so far.

Without a journal, which would be there to go back. A block fills several pages, each of which is written by itself.
"""

_INSERT = "INSERT INTO messages (topic_id, timestamp, data) VALUES"


class BulkSqlite3Writer(Sqlite3Writer):
    """Adds ``write_batch``."""

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        """Create the database as the library does, but with the settings before there is anything in it."""
        self.path = path / f"{path.name}.db3"
        # Used by two threads, never by both at once.
        self.conn = sqlite3.connect(f"file:{quote(str(self.path))}", uri=True, check_same_thread=False)
        for setting in SETTINGS:
            self.conn.execute(f"PRAGMA {setting}")
        self.conn.executescript(self.SQLITE_SCHEMA)
        self.cursor = self.conn.cursor()

    def write_batch(self, channels: Indices, batch: Batch) -> None:
        """Write messages, of the connections whose ids are ``channels`` (n,)."""
        ids, times, raws = channels.tolist(), batch.times.tolist(), batch.raws()
        for start in range(0, len(raws), ROWS):
            rows = slice(start, start + ROWS)
            values = zip(ids[rows], times[rows], raws[rows], strict=True)
            # A statement of many rows lets the other threads run meanwhile, one row does not.
            places = ",".join(["(?,?,?)"] * len(raws[rows]))
            self.cursor.execute(_INSERT + places, tuple(chain.from_iterable(values)))


class BulkWriter(Writer):
    """Adds ``write_batch``, which returns before its messages are written: a thread does that, in their order.

    Messages that are compressed one by one are not among what it can write.
    """

    STORAGE_PLUGINS = {StoragePlugin.SQLITE3: BulkSqlite3Writer, StoragePlugin.MCAP: BulkMcapWriter}  # noqa: RUF012

    def __init__(self, path: Path, **options: Any) -> None:
        """Take what the library's writer takes."""
        super().__init__(path, **options)
        self._writing = InTurn(MOST_WAITING)
        self._topics: list[int] = []
        self._times: list[int] = []
        self._raws: list[bytes] = []
        self._size = 0

    def write_batch(self, connections: Sequence[Connection], batch: Batch) -> None:
        """Write messages, whose memory must not change; each one's topic is the place of its connection in the list.

        Raises what writing an earlier batch raised.
        """
        self._flush()
        if len(batch):
            self._put(connections, batch)

    def _put(self, connections: Sequence[Connection], batch: Batch) -> None:
        for connection, count in zip(connections, np.bincount(batch.topics, minlength=len(connections)), strict=True):
            self.counts[connection.id] += int(count)
        self.min_timestamp = min(int(batch.times.min()), self.min_timestamp)
        self.max_timestamp = max(int(batch.times.max()), self.max_timestamp)
        assert isinstance(self.storage, (BulkSqlite3Writer, BulkMcapWriter))
        ids = np.array([connection.id for connection in connections], dtype=np.int64)
        self._writing.submit(self.storage.write_batch, ids[batch.topics], batch)

    def add_connection(self, *arguments: Any, **options: Any) -> Connection:
        """Add a topic."""
        self._flush()
        self._writing.wait()
        return super().add_connection(*arguments, **options)

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Write one message at a log time in ns, together with some after it."""
        self._topics.append(connection.id - 1)  # the library numbers its connections from 1
        self._times.append(timestamp)
        self._raws.append(bytes(data))
        self._size += len(data)
        if self._size >= MOST_BYTES or len(self._raws) >= MOST_MESSAGES:
            self._flush()

    def _flush(self) -> None:
        """Write the messages that came one by one."""
        if self._raws:
            batch = Batch.of_messages(self._topics, self._times, self._raws)
            self._topics, self._times, self._raws, self._size = [], [], [], 0
            self._put(self.connections, batch)

    def close(self) -> None:
        """Write what is left."""
        self._flush()
        self._writing.wait()
        self._writing.close()
        super().close()

    def abort(self) -> None:
        """Close without writing what is left."""
        self._writing.close()
        super().abort()
