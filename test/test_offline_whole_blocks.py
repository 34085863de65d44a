"""Blocks of a bag that are taken as wholes, against the same blocks looked at sample by sample."""

from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, make_calibration, make_recording
from hypothesis import given, settings
from hypothesis import strategies as st
from test_offline_run import NAMES, outputs

from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.recording import look_ahead, message_batches, offline_run, whole_blocks
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_events import merged
from hgma_compensation.recording.bag_writer import Storage, new_bag
from hgma_compensation.recording.compensated_copy import write_compensated
from hgma_compensation.recording.recording import Series
from hgma_compensation.stamps import NANOSECONDS

RECORDING = make_recording(duration_s=60.0, accel_rate=100.0, thermistor_rate=2.0, cycles=1.0, name="bag")
BLOCKS = ["/accel/raw_block"]
TROUBLES = ("nan", "huge", "gap", "frame", "interval", "empty", "uneven", "back", "zero axis")


def spoilt(message, trouble):
    """Put something into an AccelBlock that makes it unlike the others."""
    if trouble == "nan":
        message.y[len(message.y) // 2] = np.nan
    elif trouble == "huge":
        message.x[0] = 3e9
    elif trouble == "gap":
        message.header.stamp.sec += 7
    elif trouble == "back":
        message.header.stamp.sec -= 3
    elif trouble == "frame":
        message.header.frame_id = "another"
    elif trouble == "interval":
        message.sample_interval *= 0.5
    elif trouble == "empty":
        message.x = message.y = message.z = np.empty(0, dtype=np.float32)
    elif trouble == "uneven":
        message.x, message.y, message.z = (axis[:-3] for axis in (message.x, message.y, message.z))
    else:
        message.z[:] = 0.0
    return message


def write(path, recording, block, troubles, storage=Storage.MCAP):
    """Write a recording in blocks, some of which are spoilt, by their numbers."""
    number = 0
    with new_bag(path, storage) as bag:
        for time, _, topic, message in merged(bag, recording, None, block):
            if topic.topic in BLOCKS:
                message = spoilt(message, troubles[number]) if number in troubles else message
                number += 1
            bag.write(topic, time, message)
    return number


def both_ways(tmp_path, monkeypatch, calibration, rate=20.0):
    """Return what is written with blocks taken as wholes and without, and how many blocks were."""
    taken = []
    take = whole_blocks.WholeBlockReader._take

    def counted(self, *arguments):
        taken.append(take(self, *arguments))
        return taken[-1]

    def never(self, *arguments):
        return False

    figures = []
    for name in ("whole", "slow"):
        with monkeypatch.context() as patched:
            patched.setattr(whole_blocks.WholeBlockReader, "_take", counted if name == "whole" else never)
            figures.append(
                write_compensated(tmp_path / "bag", calibration, tmp_path / name, names=NAMES, state_rate=rate)
            )
    assert figures[0] == figures[1]
    return outputs(tmp_path / "whole"), outputs(tmp_path / "slow"), sum(taken)


@pytest.fixture
def small_pieces(monkeypatch):
    monkeypatch.setattr(offline_run, "PIECE", 1000)


@pytest.mark.parametrize("storage", list(Storage))
@pytest.mark.parametrize("channels", [LINEAR, LINEAR[2:], (LINEAR[0], LINEAR[2]), (LINEAR[1], CHANNELS[4])])
def test_whole_blocks_give_the_same_bytes(tmp_path, monkeypatch, small_pieces, storage, channels):
    blocks = write(tmp_path / "bag", RECORDING, 25, {}, storage)
    calibration = make_calibration(channels=channels)
    if channels[-1] == CHANNELS[4]:  # blocks carry no angular rate
        with pytest.raises(RefusedError, match="no channel angular"):
            both_ways(tmp_path, monkeypatch, calibration)
        return
    whole, slow, taken = both_ways(tmp_path, monkeypatch, calibration)
    assert whole == slow
    assert taken > 0.9 * blocks


@given(
    block=st.integers(1, 200),
    troubles=st.dictionaries(st.integers(0, 60), st.sampled_from(TROUBLES), max_size=6),
    channels=st.sampled_from([LINEAR, LINEAR[:1], LINEAR[1:]]),
    rate=st.sampled_from([0.0, 1.0, 20.0]),
    size=st.sampled_from([3000, 20_000, 1 << 20]),
)
@settings(max_examples=15)
def test_blocks_that_differ_give_the_same_bytes(tmp_path_factory, block, troubles, channels, rate, size):
    path = tmp_path_factory.mktemp("blocks")
    write(path / "bag", RECORDING, block, troubles, Storage.SQLITE3)
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(offline_run, "PIECE", size // 5)
        monkeypatch.setattr(message_batches, "BATCH", size)
        monkeypatch.setattr(look_ahead, "MOST_HELD", 4 * size)
        whole, slow, _ = both_ways(path, monkeypatch, make_calibration(channels=channels), rate)
    assert whole == slow


def test_temperatures_of_every_status_give_the_same_bytes(tmp_path, monkeypatch, small_pieces):
    """A thermistor that comes late, leaves the calibrated range, and is silent for a while."""
    stamps, values = RECORDING.temperature.stamps, RECORDING.temperature.values.copy()
    seconds = (stamps - stamps[0]) / NANOSECONDS
    values[(seconds > 12.0) & (seconds < 18.0)] += 60.0
    kept = (seconds > 3.0) & ~((seconds > 25.0) & (seconds < 50.0))
    recording = replace(RECORDING, temperature=Series(stamps[kept], values[kept]))
    write(tmp_path / "bag", recording, 25, {})
    whole, slow, taken = both_ways(tmp_path, monkeypatch, make_calibration())
    assert whole == slow
    assert taken > 100
    states = [types.typestore().deserialize_cdr(raw, types.STATE) for topic, _, raw in whole if topic == "/accel/state"]
    assert len({state.temperature_status for state in states}) > 2


def test_a_filter_that_runs_is_given_every_sample(tmp_path, monkeypatch):
    write(tmp_path / "bag", RECORDING, 25, {})
    whole, slow, taken = both_ways(tmp_path, monkeypatch, make_calibration(mode=FilterMode.SMOOTH))
    assert whole == slow
    assert taken == 0
