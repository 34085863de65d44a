"""Bags that no recorder writes, made byte by byte."""

import sqlite3
from contextlib import closing
from io import BytesIO
from pathlib import Path

import lz4.frame
from rosbags.rosbag2 import storage_mcap as mcap

MAGIC = b"\x89MCAP0\r\n"
BOMB = 1 << 30
CHANNEL = 1


def record(code: int, *parts: bytes) -> bytes:
    body = b"".join(parts)
    return bytes([code]) + len(body).to_bytes(8, "little") + body


def number(value: int, size: int) -> bytes:
    return value.to_bytes(size, "little")


def text(value: str | bytes) -> bytes:
    raw = value.encode() if isinstance(value, str) else value
    return number(len(raw), 4) + raw


def topic_records(definition: str = "", encoding: str = "", qos: str = "") -> bytes:
    """Return a schema and a channel /accel/raw of it."""
    schema = record(3, number(1, 2), text("sensor_msgs/msg/Imu"), text(encoding), text(definition))
    metadata = text("offered_qos_profiles") + text(qos) if qos else b""
    return schema + record(4, number(CHANNEL, 2), number(1, 2), text("/accel/raw"), text("cdr"), text(metadata))


def message(time: int, data: bytes = b"") -> bytes:
    return record(5, number(CHANNEL, 2), number(0, 4), number(time, 8), number(time, 8), data)


def chunk(compression: str, packed: bytes, size: int) -> bytes:
    head = number(1, 8) + number(2, 8) + number(size, 8) + number(0, 4)
    return record(6, head, text(compression), number(len(packed), 8), packed)


def statistics(count: int) -> bytes:
    head = number(count, 8) + number(1, 2) + b"".join(number(n, 4) for n in (1, 0, 0, 0)) + number(1, 8) + number(2, 8)
    return record(0x0B, head, number(10, 4), number(CHANNEL, 2), number(count, 8))


def write_mcap(
    path: Path, topic: bytes, data: bytes = b"", chunks: list[tuple[int, str, int, int]] = (), count=1
) -> Path:
    """Write a file whose summary has the topic and, for each of ``chunks``, an index.

    chunks: offset in data, compression, packed and declared size.
    """
    head = MAGIC + record(1, text("ros2"), text("made by hand"))
    summary = topic
    for offset, compression, packed, size in chunks:
        counts = number(10, 4) + number(CHANNEL, 2) + number(0, 8)
        index = number(1, 8) + number(2, 8) + number(len(head) + offset, 8) + number(packed + 60, 8) + counts
        summary += record(8, index, number(0, 8), text(compression), number(packed, 8), number(size, 8))
    start = len(head) + len(data)
    footer = record(2, number(start, 8), number(0, 8), number(0, 4))
    path.write_bytes(head + data + summary + (statistics(count) if not chunks else b"") + footer + MAGIC)
    return path


def zstd_bomb(size: int = BOMB) -> bytes:
    """Return zeros in a frame that does not say how many they are."""
    compressor = mcap.zstd.ZstdCompressor()
    packed = [compressor.compress(bytes(1 << 20)) for _ in range(size >> 20)]
    return b"".join([*packed, compressor.flush()])


def lz4_bomb(size: int = BOMB) -> bytes:
    with BytesIO() as target:
        with lz4.frame.open(target, "wb") as packed:
            for _ in range(size >> 20):
                packed.write(bytes(1 << 20))
        return target.getvalue()


def bombs(folder: Path) -> list[Path]:
    """Write files of a few kilobytes to a few megabytes, each of which once stood for more than there is memory."""
    zstd, lz4_packed = zstd_bomb(), lz4_bomb()
    made = []

    def indexed(name: str, packed: bytes, compression: str, declared: int, times: int = 1) -> None:
        data, entry = chunk(compression, packed, declared), (0, compression, len(packed), declared)
        made.append(write_mcap(folder / f"{name}.mcap", topic_records(), data, [entry] * times))

    indexed("honest_zstd", zstd, "zstd", BOMB)
    indexed("lying_zstd", zstd, "zstd", 1000)
    indexed("lying_lz4", lz4_packed, "lz4", 1000)
    indexed("one_chunk_many_times", zstd_bomb(64 << 20), "zstd", 64 << 20, times=200)
    unindexed = write_mcap(folder / "unindexed.mcap", b"", topic_records() + chunk("zstd", zstd, BOMB))
    made.append(unindexed)
    small = chunk("zstd", zstd_bomb(16 << 20), 16 << 20) * 100
    made.append(write_mcap(folder / "unindexed_small.mcap", b"", topic_records() + small))
    made.append(write_mcap(folder / "many_messages.mcap", topic_records(), message(1), count=1 << 40))
    shift = "module a { const int64 B = 1 << 90000000000; };"
    made.append(write_mcap(folder / "definition.mcap", topic_records(shift, "ros2idl")))
    laughs = "a: &a0 {k: v}\n" + "".join(f"b{n}: &a{n + 1} {{<<: [{','.join([f'*a{n}'] * 9)}]}}\n" for n in range(30))
    made.append(write_mcap(folder / "qos.mcap", topic_records(qos=laughs)))
    return made


def write_database(path: Path, *statements: str) -> Path:
    with closing(sqlite3.connect(path)) as database:
        for statement in statements:
            database.execute(statement)
        database.commit()
    return path


TOPICS = (
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT,"
    " offered_qos_profiles TEXT)"
)
ONE_TOPIC = "INSERT INTO topics VALUES(1, '/accel/raw', 'sensor_msgs/msg/Imu', 'cdr', '')"
