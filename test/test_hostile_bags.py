import json
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from builders import make_recording
from hostile_bags import ONE_TOPIC, TOPICS, bombs, write_database
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from refusals import refusal_of

from hgma_compensation.errors import RefusedError
from hgma_compensation.node.message_types import message_class
from hgma_compensation.recording.bag_reader import read_recording
from hgma_compensation.recording.bag_writer import Storage, write_recording

READER = Path(__file__).with_name("read_within_limits.py")
LARGEST_PEAK = 300
"""MB resident of a process that refused them all, the interpreter and numpy included."""

RECORDING = make_recording(duration_s=20.0, accel_rate=10.0, thermistor_rate=2.0, cycles=1.0)


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """Answer and peak for each file, by its name, of one process with little memory."""
    files = bombs(tmp_path_factory.mktemp("bombs"))
    done = subprocess.run([sys.executable, READER, *files], capture_output=True, text=True, check=True)
    return {Path(name).stem: (answer, peak) for name, answer, _, peak in map(json.loads, done.stdout.splitlines())}


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("honest_zstd", "honest_zstd.mcap unpacks to more than"),
        ("lying_zstd", "expected 1000 bytes, got 1001"),
        ("lying_lz4", "expected 1000 bytes, got 1001"),
        ("one_chunk_many_times", "unpacks to more than"),
        ("unindexed", "unpacks to more than"),
        ("unindexed_small", "unpacks to more than"),
        ("many_messages", "a message on /accel/raw is damaged"),
        ("definition", "holds no sample on /accel/raw"),
        ("qos", "its aliases stand for more than"),
    ],
)
def test_a_file_that_stands_for_more_than_the_memory_is_refused_in_a_little_of_it(answers, name, reason):
    answer, peak = answers[name]
    assert answer.startswith("bag ")
    assert reason in answer
    assert peak < LARGEST_PEAK


def test_a_database_that_computes_its_messages_is_refused(tmp_path):
    blob = "data BLOB AS (zeroblob(1000000000))"
    table = f"CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, {blob})"
    path = write_database(tmp_path / "made.db3", table, TOPICS, ONE_TOPIC, "INSERT INTO messages VALUES(1,1,1)")
    with pytest.raises(RefusedError, match="computes its tables"):
        read_recording(path)


def test_a_database_whose_messages_are_an_endless_query_is_refused(tmp_path):
    rows = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i+1 FROM n) SELECT i,1,i,x'00' FROM n"
    view = f"CREATE VIEW messages(id,topic_id,timestamp,data) AS {rows}"
    with pytest.raises(RefusedError, match="computes its tables"):
        read_recording(write_database(tmp_path / "endless.db3", TOPICS, ONE_TOPIC, view))


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("../secret/secret.mcap", "secret.mcap cannot be read .No such file"),
        ("/etc/passwd", "passwd cannot be read .No such file"),
        ("elsewhere/pipe.mcap", "pipe.mcap is not a regular file"),
    ],
)
def test_metadata_cannot_name_a_file_outside_of_the_bag_or_one_that_blocks(tmp_path, name, reason):
    write_recording(RECORDING, tmp_path / "secret")
    bag = shutil.copytree(tmp_path / "secret", tmp_path / "bag")
    (bag / "secret.mcap").unlink()
    os.mkfifo(bag / "pipe.mcap")
    metadata = yaml.safe_load((bag / "metadata.yaml").read_text())
    metadata["rosbag2_bagfile_information"]["relative_file_paths"] = [name]
    (bag / "metadata.yaml").write_text(yaml.safe_dump(metadata))
    with pytest.raises(RefusedError, match=f"{bag}/{reason}"):
        read_recording(bag)


@pytest.fixture(scope="module")
def storages(tmp_path_factory):
    """The bytes of one recording in each storage, and a folder to put damaged ones in."""
    folder = tmp_path_factory.mktemp("storages")
    contents = {}
    for storage, suffix in ((Storage.MCAP, ".mcap"), (Storage.SQLITE3, ".db3")):
        write_recording(RECORDING, folder / storage.value, storage)
        (file,) = (folder / storage.value).glob(f"*{suffix}")
        contents[suffix] = file.read_bytes()
    return folder, contents


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32), suffix=st.sampled_from([".mcap", ".db3"]))
def test_a_bag_with_flipped_bytes_is_read_or_refused_in_one_line(storages, seed, suffix):
    folder, contents = storages
    chance, damaged = random.Random(seed), bytearray(contents[suffix])
    for _ in range(chance.randrange(1, 20)):
        near_an_end = chance.choice((0, max(len(damaged) - 2000, 0)))
        at = chance.choice((chance.randrange(len(damaged)), near_an_end + chance.randrange(2000)))
        damaged[at % len(damaged)] = chance.choice((0, 1, 127, 255, chance.randrange(256)))
    path = folder / f"damaged{suffix}"
    path.write_bytes(damaged)
    assert (refusal_of(read_recording, path) or f"bag {path}").startswith(f"bag {path}")


@pytest.mark.parametrize("name", ["os/path/join", "antigravity", "../msg/Imu", "sensor_msgs/msg/Imu\n", "a.b/msg/C"])
def test_the_name_of_a_type_imports_nothing_but_messages(name):
    with pytest.raises(ModuleNotFoundError, match="is no type of messages"):
        message_class(name)
