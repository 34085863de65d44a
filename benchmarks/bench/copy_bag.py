"""The rival of the offline commands: ``python -m benchmarks.bench.copy_bag FROM TO STORAGE``.

Reads every message of a bag with rosbags and writes it, as it is, into another one: nothing between. Compressed as hgma
compresses.
"""

import sys
from pathlib import Path

from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer


def main() -> int:
    """Copy."""
    source, target, storage = sys.argv[1:]
    writer = Writer(Path(target), version=9, storage_plugin=StoragePlugin[storage.upper()])
    if storage == "mcap":
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with Reader(Path(source)) as reader, writer:
        copies = {
            connection.id: writer.add_connection(
                connection.topic, connection.msgtype, msgdef=connection.msgdef.data, rihs01=connection.digest
            )
            for connection in reader.connections
        }
        for connection, time, raw in reader.messages():
            writer.write(copies[connection.id], time, raw)
    return 0


if __name__ == "__main__":
    sys.exit(main())
