"""What the commands write is what rosbag2 of Jazzy reads and plays, judged by readers that are not ours.

MCAP by the official library (mcap, mcap-ros2-support); SQLite and metadata.yaml by the layout in rosbag2's sources
(rosbag2_storage_sqlite3/sqlite_storage.cpp, rosbag2_storage/yaml.hpp and qos.cpp); types by the hashes of the
installed message packages.
"""

import json
import re
import sqlite3
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
import yaml
from builders import make_calibration, make_recording
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from simulation_scenarios import write_scenario

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.cli.main import main
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_writer import Storage, write_recording
from hgma_compensation.topics import INPUTS, OUTPUTS, in_bag

RECORDING = make_recording(duration_s=60.0, accel_rate=20.0, cycles=1.0, name="bag")
COMMANDS = ("simulate", "import-csv", "compensate", "compensate blocks")


def hgma(*words):
    assert main([str(word) for word in words]) == 0


def write(command, folder, storage):
    """Let a command write the bag folder/bag."""
    out = folder / "bag"
    made = ["-o", out, "--storage", storage.value]
    if command == "simulate":
        hgma("simulate", write_scenario(folder), *made)
    elif command == "import-csv":
        rows = np.column_stack([np.arange(200) * 0.1, np.linspace(20.0, 30.0, 200), np.full(200, 9.81)])
        np.savetxt(folder / "table.csv", rows, delimiter=",", header="t,T,az", comments="")
        hgma(
            "import-csv",
            folder / "table.csv",
            "--time",
            "t",
            "--temperature",
            "T",
            "--linear-acceleration-z",
            "az",
            *made,
        )
    else:
        write_calibration(make_calibration(), folder / "cal.json")
        write_recording(RECORDING, folder / "in", storage, block=10 if command.endswith("blocks") else 1)
        hgma("compensate", folder / "in", "--calibration", folder / "cal.json", *made)
    return out


@pytest.fixture(scope="module")
def bags(tmp_path_factory):
    made = {}

    def bag(command, storage):
        if (command, storage) not in made:
            made[command, storage] = write(command, tmp_path_factory.mktemp("bags"), storage)
        return made[command, storage]

    return bag


def equal(decoded, message):
    """Whether a message decoded by the other library, by the definition in the bag, has the fields of ours."""
    if hasattr(message, "__dataclass_fields__"):
        names = [name for name, _ in types.typestore().fielddefs[message.__msgtype__][1]]
        return all(equal(getattr(decoded, name), getattr(message, name)) for name in names)
    if isinstance(message, (np.ndarray, list, tuple)):
        return len(decoded) == len(message) and all(map(equal, decoded, message))
    return decoded == message


@pytest.mark.parametrize("command", COMMANDS)
def test_the_official_library_reads_every_message_alike(bags, command):
    (file,) = bags(command, Storage.MCAP).glob("*.mcap")
    with Reader(file.parent) as ours, file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        header, summary = reader.get_header(), reader.get_summary()
        assert header.profile == "ros2"
        assert {channel.message_encoding for channel in summary.channels.values()} == {"cdr"}
        assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
        assert {index.compression for index in summary.chunk_indexes} == {"zstd"}
        theirs = list(reader.iter_decoded_messages())
        assert all(message.publish_time == message.log_time for _, _, message, _ in theirs)
        read = [(message.log_time, channel.topic, schema.name, message.data) for schema, channel, message, _ in theirs]
        assert [time for time, *_ in read] == sorted(time for time, *_ in read)
        expected = [(time, one.topic, one.msgtype, bytes(raw)) for one, time, raw in ours.messages()]
        assert sorted(read) == sorted(expected)
        assert len(read) == summary.statistics.message_count == ours.message_count > 0
    for schema, _, message, decoded in theirs:
        assert equal(decoded, types.typestore().deserialize_cdr(message.data, schema.name))


@pytest.mark.parametrize("command", COMMANDS)
def test_every_record_of_the_file_is_one_that_the_specification_knows(bags, command):
    (file,) = bags(command, Storage.MCAP).glob("*.mcap")
    with file.open("rb") as stream:
        kinds = {type(record).__name__ for record in StreamReader(stream, validate_crcs=True).records}
    assert {"Header", "Schema", "Channel", "Message", "MessageIndex", "ChunkIndex", "Statistics", "Footer"} <= kinds


@pytest.mark.parametrize("storage", list(Storage))
@pytest.mark.parametrize("command", COMMANDS)
def test_metadata_is_what_rosbag2_decodes(bags, command, storage):
    bag = bags(command, storage)
    info = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert info["version"] == 9
    assert info["storage_identifier"] == storage.value
    assert (info["compression_format"], info["compression_mode"]) == ("", "")
    assert info["relative_file_paths"] == [file["path"] for file in info["files"]]
    assert all((bag / name).is_file() for name in info["relative_file_paths"])
    assert sum(file["message_count"] for file in info["files"]) == info["message_count"]
    topics = info["topics_with_message_count"]
    assert sum(topic["message_count"] for topic in topics) == info["message_count"]
    assert info["starting_time"]["nanoseconds_since_epoch"] > 0
    assert info["duration"]["nanoseconds"] > 0
    for topic in (topic["topic_metadata"] for topic in topics):
        assert topic["name"].startswith("/")
        assert topic["serialization_format"] == "cdr"
        # None: rosbag2 then offers its default, reliable and volatile, which every reader hears.
        assert topic["offered_qos_profiles"] == []
        assert topic["type_description_hash"].strip() == installed_hash(topic["type"])
    assert {topic["topic_metadata"]["name"] for topic in topics} & {in_bag(topic) for topic in INPUTS + OUTPUTS}


def installed_hash(message_type):
    """Return the hash that rosidl computed when the message package was built."""
    package, _, name = message_type.split("/")
    description = Path(sys.prefix, "share", package, "msg", f"{name}.json").read_text()
    hashes = {one["type_name"]: one["hash_string"] for one in json.loads(description)["type_hashes"]}
    return hashes[message_type]


SCHEMA = {
    "schema": ["schema_version", "ros_distro"],
    "metadata": ["id", "metadata_version", "metadata"],
    "topics": ["id", "name", "type", "serialization_format", "offered_qos_profiles", "type_description_hash"],
    "message_definitions": ["id", "topic_type", "encoding", "encoded_message_definition", "type_description_hash"],
    "messages": ["id", "topic_id", "timestamp", "data"],
}
"""Tables that SqliteStorage::initialize makes."""


@pytest.mark.parametrize("command", COMMANDS)
def test_a_database_has_the_tables_of_rosbag2(bags, command):
    (file,) = bags(command, Storage.SQLITE3).glob("*.db3")
    with closing(sqlite3.connect(file)) as database:
        tables = {
            name: [column for _, column, *_ in database.execute(f"PRAGMA table_info({name})")]
            for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        }
        assert tables == SCHEMA
        assert database.execute("SELECT schema_version FROM schema").fetchall() == [(4,)]
        assert database.execute("SELECT metadata_version FROM metadata").fetchall() == [(9,)]
        assert [name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'index'")] == [
            "timestamp_idx"
        ]
        topics = database.execute("SELECT type, offered_qos_profiles, type_description_hash FROM topics").fetchall()
        assert all((yaml.safe_load(qos), digest) == ([], installed_hash(kind)) for kind, qos, digest in topics)
        definitions = dict(database.execute("SELECT topic_type, encoded_message_definition FROM message_definitions"))
        assert set(definitions) == {kind for kind, _, _ in topics}
        assert all(re.search(r"^MSG: std_msgs/Header$", text, re.MULTILINE) for text in definitions.values())
        assert database.execute("SELECT count(*) FROM messages").fetchone()[0] > 0
