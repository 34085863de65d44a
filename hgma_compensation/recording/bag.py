"""An open rosbag2 recording, read within bounds and by our own message definitions."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader

from hgma_compensation.recording import decoder_limits, message_batches
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_checks import check_chunks, check_file, storage_files
from hgma_compensation.recording.batch import Batch

decoder_limits.install()


class Bag:
    """A rosbag2 folder, or one .mcap or .db3 file of it, open for reading.

    The definitions of messages that a bag carries are never used: rosbags makes Python code of them. Raises what the
    library raises, of any kind, besides RefusedError, where the bag is damaged.
    """

    def __init__(self, path: Path) -> None:
        """Open a bag."""
        files = storage_files(path)
        for file in files:
            check_file(file)
        self._reader = Reader(path)
        self._reader.open()
        try:
            storage = self._reader.storage
            for part, file in zip(getattr(storage, "storages", [storage]), files, strict=True):
                check_chunks(getattr(part, "chunks", ()), file)
            self.connections: list[Connection] = self._reader.connections
            self._unpacks_messages = storage.metadata.compression_mode == "message"
            # So that the library hands the messages out as they are: it would unpack them without a limit.
            storage.metadata = storage.metadata._replace(compression_mode=None)
        except BaseException:
            self._reader.close()
            raise

    @property
    def message_count(self) -> int:
        """Number of messages that the bag declares."""
        return int(self._reader.message_count)

    def close(self) -> None:
        """Close the files."""
        self._reader.close()

    def messages(self, connections: list[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield topic, log time in ns and serialised message of some topics, or of all for an empty list."""
        for connection, time, raw in self._reader.messages(connections):
            yield connection, time, decoder_limits.unpack_message(raw) if self._unpacks_messages else raw

    def batches(self, connections: list[Connection]) -> Iterator[Batch]:
        """Yield the messages of some topics many at a time, in the order of ``messages``.

        A topic in a batch is the place of its connection in the list.
        """
        return message_batches.batches(self._reader.storage, connections, packed=self._unpacks_messages)

    def deserialize(self, raw: bytes, message_type: str) -> Any:
        """Return the message, of a type of ROS 2 Jazzy or hgma_msgs."""
        return types.typestore_of(message_type).deserialize_cdr(raw, message_type)
