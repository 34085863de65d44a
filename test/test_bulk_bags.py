"""Bags read and written many messages at a time, against the library that does it one by one."""

import shutil
import struct
from io import BytesIO
from itertools import pairwise

import numpy as np
import pytest
from builders import make_recording
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer
from rosbags.rosbag2 import storage_mcap as mcap

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording import bulk_writer, mcap_records, message_batches
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_reader import open_bag, read_recording
from hgma_compensation.recording.bag_writer import Storage, new_bag, write_recording
from hgma_compensation.recording.batch import Batch, joined
from hgma_compensation.recording.mcap_records import find_messages

RECORDING = make_recording(duration_s=20.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0, name="bag")
MESSAGES = st.lists(
    st.tuples(st.integers(0, 2), st.integers(0, 50), st.binary(min_size=0, max_size=9)), min_size=1, max_size=40
)


def write(path, chunks, storage=StoragePlugin.MCAP):
    """Write messages (topic, time, data) with the library alone, each list of them in a chunk of its own."""
    shutil.rmtree(path, ignore_errors=True)
    with Writer(path, version=9, storage_plugin=storage) as writer:
        topics = [
            writer.add_connection(f"/topic_{n}", types.TEMPERATURE, typestore=types.typestore()) for n in range(3)
        ]
        for chunk in chunks:
            for topic, time, data in chunk:
                writer.write(topics[topic], time, data)
            if storage is StoragePlugin.MCAP and chunk:
                writer.storage.close_chunk()


def in_bulk(path, wanted=None):
    with open_bag(path) as bag:
        connections = [bag.connections[n] for n in wanted or range(len(bag.connections))]
        batches = list(bag.batches(connections))
        return [
            (connections[topic].topic, time, raw)
            for batch in batches
            for topic, time, raw in zip(batch.topics.tolist(), batch.times.tolist(), batch.raws(), strict=True)
        ]


def one_by_one(path, wanted=None):
    with Reader(path) as reader:
        connections = [reader.connections[n] for n in wanted or range(len(reader.connections))]
        return [(connection.topic, time, raw) for connection, time, raw in reader.messages(connections)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bulk")


@settings(max_examples=25)
@given(chunks=st.lists(MESSAGES, min_size=1, max_size=5), wanted=st.sampled_from([None, [0], [2, 1]]))
def test_chunks_that_overlap_are_read_in_the_order_of_the_library(folder, chunks, wanted):
    write(folder / "overlap", chunks)
    assert in_bulk(folder / "overlap", wanted) == one_by_one(folder / "overlap", wanted)


@settings(max_examples=25)
@given(messages=MESSAGES)
def test_a_database_is_read_in_the_order_of_the_library(folder, messages):
    write(folder / "database", [messages], StoragePlugin.SQLITE3)
    assert in_bulk(folder / "database") == one_by_one(folder / "database")


def test_windows_of_overlapping_chunks_hold_all_messages_in_order(tmp_path, monkeypatch):
    monkeypatch.setattr("hgma_compensation.recording.mcap_batches.MOST_MESSAGES", 7)
    monkeypatch.setattr(message_batches, "BATCH", 0)
    random = np.random.default_rng(3)
    chunks = [
        [(int(n), int(t), bytes([t])) for n, t in random.integers(0, (3, 90), (60, 2)).tolist()] for _ in range(4)
    ]
    write(tmp_path / "bag", chunks)
    assert in_bulk(tmp_path / "bag") == one_by_one(tmp_path / "bag")


@pytest.mark.parametrize("kind", ["message", "file", "unindexed", "split"])
@pytest.mark.parametrize("storage", list(Storage))
def test_bags_of_other_forms_are_read_alike(tmp_path, storage, kind):
    path = tmp_path / "bag"
    if kind in ("message", "file"):
        writer = Writer(path, version=9, storage_plugin=StoragePlugin[storage.name])
        writer.set_compression(CompressionMode[kind.upper()], CompressionFormat.ZSTD)
        with writer:
            topic = writer.add_connection("/topic", types.TEMPERATURE, typestore=types.typestore())
            for time in range(300):
                writer.write(topic, time, bytes([time % 256]) * 20)
        assert in_bulk(path) == [("/topic", time, bytes([time % 256]) * 20) for time in range(300)]
        return
    write_recording(RECORDING, path, storage)
    if kind == "unindexed":
        if storage is Storage.SQLITE3:
            return
        file = next(path.glob("*.mcap"))
        strip_summary(file)
        assert in_bulk(file) == one_by_one(file)
        return
    split(path, storage)
    assert in_bulk(path) == one_by_one(path)
    assert len(in_bulk(path)) == 2 * (len(RECORDING.stamps) + len(RECORDING.temperature.stamps))


def strip_summary(file):
    """Make a file as a recorder leaves it that writes no summary, and lets the messages lie outside of chunks."""
    with Reader(file) as reader:
        messages = list(reader.messages())
        definitions = BytesIO()
        for schema in reader.storage.schemas.values():
            mcap.write_schema(definitions, schema)
        for channel in reader.storage.channels.values():
            mcap.write_channel(definitions, channel, list(reader.storage.schemas.values()))
    with file.open("wb") as made:
        made.write(b"\x89MCAP0\r\n")
        head = BytesIO()
        mcap.write_string(head, "ros2")
        mcap.write_string(head, "test")
        mcap.write_record(made, 1, head)
        made.write(definitions.getvalue())
        for connection, time, raw in messages:
            made.write(struct.pack("<BQHIQQ", 5, 22 + len(raw), connection.id, 0, time, time) + raw)
        made.write(struct.pack("<BQQQI", 2, 20, 0, 0, 0) + b"\x89MCAP0\r\n")


def split(path, storage):
    """Make a bag of two files out of one, both with the same messages."""
    (file,) = (one for one in path.iterdir() if one.name != "metadata.yaml")
    other = file.with_stem(file.stem + "_1")
    shutil.copy(file, other)
    metadata = (path / "metadata.yaml").read_text()
    (path / "metadata.yaml").write_text(metadata.replace(f"- {file.name}", f"- {file.name}\n  - {other.name}"))


def chunk_of(records):
    """Return a chunk of (kind, channel, time, data) records and the offsets of its messages."""
    chunk, offsets = b"", []
    for kind, channel, time, data in records:
        if kind == 5:
            offsets.append((channel, time, len(chunk)))
            data = struct.pack("<HIQQ", channel, 0, time, time) + data
        chunk += struct.pack("<BQ", kind, len(data)) + data
    return chunk, offsets


def index_of(offsets):
    index = b""
    for channel in sorted({channel for channel, _, _ in offsets}):
        entries = b"".join(struct.pack("<QQ", t, at) for c, t, at in offsets if c == channel)
        index += struct.pack("<BQHI", 7, 6 + len(entries), channel, len(entries)) + entries
    return index


RECORDS = st.lists(
    st.tuples(st.sampled_from([3, 5, 5, 5]), st.integers(0, 3), st.integers(0, 9), st.binary(max_size=8)), max_size=20
)


@given(records=RECORDS, spoilt=st.lists(st.tuples(st.integers(0, 10**6), st.integers(0, 255)), max_size=3))
def test_whatever_the_indexes_say_the_messages_are_those_of_a_walk(records, spoilt):
    chunk, offsets = chunk_of(records)
    expected = mcap_records._walked(chunk)
    right, index = index_of(offsets), bytearray(index_of(offsets))
    for place, value in spoilt:
        if index:
            index[place % len(index)] = value
    for given_index in (
        right,
        bytes(index),
        right[: len(right) // 2],
        index_of(offsets[1:]),
        index_of(offsets[:1] * 2),
    ):
        found = find_messages(chunk, given_index)
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_array_equal(one, other)
    assert [chunk[a : a + n] for a, n in zip(expected.starts, expected.sizes, strict=True)] == [
        data for kind, _, _, data in records if kind == 5
    ]


def test_right_indexes_spare_the_walk(monkeypatch):
    chunk, offsets = chunk_of([(3, 0, 0, b"definition"), (5, 1, 4, b"abc"), (5, 2, 3, b""), (4, 0, 0, b"x")])
    expected = mcap_records._walked(chunk)
    monkeypatch.setattr(mcap_records, "_walked", lambda chunk: pytest.fail("walked"))
    np.testing.assert_array_equal(find_messages(chunk, index_of(offsets)).starts, expected.starts)


@pytest.mark.parametrize("storage", list(Storage))
@settings(max_examples=15)
@given(messages=MESSAGES, cuts=st.lists(st.integers(0, 40), max_size=3))
def test_messages_written_in_bulk_are_those_written_one_by_one(folder, storage, messages, cuts):
    made = [folder / f"{storage.value}_{name}" for name in ("bulk", "single")]
    for number, path in enumerate(made):
        shutil.rmtree(path, ignore_errors=True)
        with new_bag(path, storage) as bag:
            connections = [bag.topic(f"/topic_{n}", types.TEMPERATURE) for n in range(3)]
            if number:
                for topic, time, data in messages:
                    bag.write_raw(connections[topic], time, data)
            else:
                edges = sorted({0, *(min(cut, len(messages)) for cut in cuts), len(messages)})
                for start, stop in pairwise(edges):
                    bag.write_batch(connections, Batch.of_messages(*zip(*messages[start:stop], strict=True)))
    bulk, single = (one_by_one(path) for path in made)
    assert bulk == single == sorted(bulk, key=lambda message: message[1])
    assert len(bulk) == len(messages)
    texts = [(path / "metadata.yaml").read_text().replace(path.name, "bag") for path in made]
    assert texts[0] == texts[1]


def test_a_file_written_in_bulk_is_what_the_specification_asks_for(tmp_path, monkeypatch):
    monkeypatch.setattr("hgma_compensation.recording.mcap_bulk_writer.CHUNK", 3000)
    random = np.random.default_rng(1)
    raws = [random.bytes(size) for size in random.integers(0, 200, 300)]
    numbers = random.integers(0, 2, 300)
    with new_bag(tmp_path / "bag") as bag:
        connections = [bag.topic(f"/topic_{n}", types.TEMPERATURE) for n in range(2)]
        bag.write_batch(connections, Batch.of_messages(numbers.tolist(), list(range(300)), raws))
    content = (tmp_path / "bag" / "bag.mcap").read_bytes()
    records, place = [], 8
    while place < len(content) - 8:
        kind, length = struct.unpack_from("<BQ", content, place)
        records.append((kind, place, content[place + 9 : place + 9 + length]))
        place += 9 + length
    assert place == len(content) - 8
    chunks = [(place, body) for kind, place, body in records if kind == 6]
    indexes = [struct.unpack_from("<QQQQ", body) for kind, _, body in records if kind == 8]
    assert len(chunks) == len(indexes) > 3
    seen = []
    for (place, body), (first, last, start, length) in zip(chunks, indexes, strict=True):
        assert (start, length) == (place, len(body) + 9)
        size, name = struct.unpack_from("<Q", body, 16)[0], struct.unpack_from("<I", body, 28)[0]
        data = mcap.decompress(body[40 + name :], "zstd", size, 0)
        found = mcap_records._walked(data)
        assert (first, last) == (found.times.min(), found.times.max())
        after = next(n for n, record in enumerate(records) if record[1] == place) + 1
        entries = []
        while records[after][0] == 7:
            index = records[after][2]
            channel, count = struct.unpack_from("<HI", index)
            entries += [(channel, *struct.unpack_from("<QQ", index, 6 + n)) for n in range(0, count, 16)]
            after += 1
        offsets = (found.starts - mcap_records.MESSAGE_HEAD.itemsize).tolist()
        assert sorted(entries) == sorted(zip(found.channels.tolist(), found.times.tolist(), offsets, strict=True))
        seen += [data[a : a + n] for a, n in zip(found.starts, found.sizes, strict=True)]
    assert seen == raws
    (statistics,) = (body for kind, _, body in records if kind == 11)
    assert struct.unpack_from("<QHIIIIQQ", statistics) == (300, 1, 2, 0, 1, len(chunks), 0, 299)


def write_one(path):
    with new_bag(path) as bag:
        bag.write_batch([bag.topic("/topic", types.TEMPERATURE)], Batch.of_messages([0], [1], [b"x"]))


def test_an_error_of_the_writing_thread_reaches_the_caller_and_leaves_nothing(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("hgma_compensation.recording.mcap_bulk_writer.BulkMcapWriter.write_batch", full)
    with pytest.raises(RefusedError, match="No space left on device"):
        write_one(tmp_path / "bag")
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_one_line_whatever_the_storage_and_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(bulk_writer, "SETTINGS", (*bulk_writer.SETTINGS, "max_page_count=20"))
    with pytest.raises(RefusedError, match=r"out cannot be written .*full.*choose another place"):
        write_recording(make_recording(duration_s=2000.0, accel_rate=10.0), tmp_path / "out", Storage.SQLITE3)
    assert list(tmp_path.iterdir()) == []


def test_a_recording_of_many_chunks_is_read_as_it_was_written(tmp_path, monkeypatch):
    monkeypatch.setattr("hgma_compensation.recording.mcap_bulk_writer.CHUNK", 5000)
    write_recording(RECORDING, tmp_path / "bag")
    read = read_recording(tmp_path / "bag")
    assert read.stamps.tobytes() == RECORDING.stamps.tobytes()
    assert read.values.tobytes() == RECORDING.values.tobytes()
    assert read.temperature.values.tobytes() == RECORDING.temperature.values.tobytes()


@given(st.lists(st.binary(min_size=1, max_size=9), min_size=1, max_size=20), st.data())
def test_messages_that_lie_apart_are_those_that_lie_together(raws, data):
    count = len(raws)
    apart = Batch.of_messages(list(range(count)), list(range(count)), raws)
    together = Batch(apart.topics, apart.times, apart.memory, apart.starts, apart.sizes)
    rows = np.array(data.draw(st.lists(st.integers(0, count - 1), unique=True)), dtype=np.int64)
    for batch in (apart, together, joined([apart, together]).select(slice(count, None))):
        chosen = batch.select(rows)
        assert chosen.raws() == [raws[row] for row in rows]
        assert [bytes(chosen.raw(row)) for row in range(len(rows))] == chosen.raws()
        assert chosen.compact().raws() == chosen.raws()
        assert chosen.size == sum(map(len, chosen.raws()))
        for same in chosen.same_sizes():
            some = chosen.select(same)
            assert [row.tobytes() for row in some.rows()] == some.raws()
