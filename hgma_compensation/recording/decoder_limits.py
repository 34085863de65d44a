"""Limits for what rosbags decodes without any: compressed chunks, and the QoS of a topic as YAML.

The library looks its decoders up in a table and by a name of its modules, where these are put in their place.
"""

from collections.abc import Callable
from typing import Any

from lz4.frame import LZ4FrameDecompressor
from rosbags.rosbag2 import metadata, storage_mcap, storage_sqlite3
from rosbags.rosbag2.errors import ReaderError

from hgma_compensation.errors import RefusedError
from hgma_compensation.plain_yaml import load_plain

LARGEST_CHUNK = 128 << 20
"""Bytes of a chunk or a message that is unpacked; recorders write chunks of one to ten megabytes."""

Decoder = Callable[[bytes, int], bytes]


def unpack(data: bytes, size: int, decompressor: Any) -> bytes:
    """Return ``size`` bytes at the most, and one more where there are more; raises ReaderError for an absurd size."""
    if size > LARGEST_CHUNK:
        raise ReaderError(f"a chunk of {size} bytes, more than {LARGEST_CHUNK}")
    unpacked: bytes = decompressor.decompress(data, max_length=size + 1)
    return unpacked


def unpack_zstd(data: bytes, size: int) -> bytes:
    """Unpack one zstd frame as ``unpack`` does."""
    return unpack(data, size, storage_mcap.zstd.ZstdDecompressor())


def unpack_lz4(data: bytes, size: int) -> bytes:
    """Unpack one LZ4 frame as ``unpack`` does."""
    return unpack(data, size, LZ4FrameDecompressor())


def unpack_message(data: bytes) -> bytes:
    """Return a message that was compressed by itself, which does not say how large it is."""
    unpacked = unpack_zstd(data, LARGEST_CHUNK)
    if len(unpacked) > LARGEST_CHUNK:
        raise ReaderError(f"a message of more than {LARGEST_CHUNK} bytes")
    return unpacked


def parse_qos(profiles: Any) -> Any:
    """Return QoS profiles as rosbags does, of a text that stays small when it is read."""
    if isinstance(profiles, str):
        try:
            load_plain(profiles)
        except RefusedError as refusal:
            raise ReaderError(f"offered_qos_profiles {refusal}") from None
    return metadata.parse_qos(profiles)


def install() -> None:
    """Put the limits in place; safe to call again."""
    storage_mcap.DECOMPRESSORS.update({"zstd": unpack_zstd, "lz4": unpack_lz4})
    for module in (storage_mcap, storage_sqlite3):
        vars(module)["parse_qos"] = parse_qos
