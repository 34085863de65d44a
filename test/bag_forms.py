"""Bags in the forms in which rosbag2 records: compressed as files or message by message, and split into files."""

import shutil

import yaml
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer

from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_writer import Storage, write_recording

FORMS = ("plain", "message", "file", "split", "split_file")
INFORMATION = "rosbag2_bagfile_information"


def written(recording, path, storage=Storage.MCAP, form="plain"):
    """Write a recording in one of the forms."""
    if form.startswith("split"):
        return _split(recording, path, storage, form)
    write_recording(recording, path, storage)
    return path if form == "plain" else _compressed(path, storage, form)


def _compressed(path, storage, form):
    plain = path.with_name(path.name + "_plain")
    path.rename(plain)
    writer = Writer(path, version=9, storage_plugin=StoragePlugin[storage.name])
    writer.set_compression(CompressionMode[form.upper()], CompressionFormat.ZSTD)
    with Reader(plain) as reader, writer:
        made = {
            one.id: writer.add_connection(one.topic, one.msgtype, typestore=types.typestore())
            for one in reader.connections
        }
        for connection, time, raw in reader.messages():
            writer.write(made[connection.id], time, raw)
    shutil.rmtree(plain)
    return path


def _split(recording, path, storage, form):
    """Write two halves as the files _0 and _1 of one bag, as --max-bag-duration does."""
    half = (recording.stamps[-1] - recording.stamps[0]) * 0.5e-9
    path.mkdir()
    parts = []
    for number, span in enumerate(((0.0, half), (half, None))):
        part = path.with_name(f"{path.name}_{number}")
        written(recording.cut(*span), part, storage, "file" if form == "split_file" else "plain")
        parts.append(yaml.safe_load((part / "metadata.yaml").read_text())[INFORMATION])
        shutil.move(part / parts[-1]["files"][0]["path"], path)
        shutil.rmtree(part)
    first, second = parts
    end = second["starting_time"]["nanoseconds_since_epoch"] + second["duration"]["nanoseconds"]
    first["duration"] = {"nanoseconds": end - first["starting_time"]["nanoseconds_since_epoch"]}
    first["message_count"] += second["message_count"]
    for one, other in zip(first["topics_with_message_count"], second["topics_with_message_count"], strict=True):
        assert one["topic_metadata"]["name"] == other["topic_metadata"]["name"]
        one["message_count"] += other["message_count"]
    for key in ("files", "relative_file_paths"):
        first[key] += second[key]
    (path / "metadata.yaml").write_text(yaml.safe_dump({INFORMATION: first}))
    return path
