"""Bags compensated in windows, against the same recordings compensated whole."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from builders import EPOCH, LINEAR, make_calibration, make_recording
from effect_calibrations import OFFERED, applied, with_all_inputs
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation import topics
from hgma_compensation.cdr.imu import ImuBatch
from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.compensated import Compensated, joined
from hgma_compensation.pipeline.state_fields import state_fields
from hgma_compensation.pipeline.state_rate import StateRate
from hgma_compensation.recording import accelerations, look_ahead, message_batches, offline_run
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_events import merged
from hgma_compensation.recording.bag_reader import open_bag, read_messages, read_recording
from hgma_compensation.recording.bag_topics import BagTopics
from hgma_compensation.recording.bag_writer import Storage, new_bag, write_recording
from hgma_compensation.recording.compensated_bag import compensate_recording
from hgma_compensation.recording.compensated_copy import write_compensated
from hgma_compensation.recording.offline_run import OfflineRun
from hgma_compensation.recording.recording import Series
from hgma_compensation.recording.state_rows import StateRows
from hgma_compensation.stamps import NANOSECONDS

RECORDING = make_recording(duration_s=120.0, accel_rate=20.0, thermistor_rate=2.0, cycles=1.0, name="bag")
NAMES = topics.TopicNames()


def write(path, recording, late=None, block=1, storage=Storage.MCAP):
    """Write a recording whose messages of some topics are logged so many s after their stamps."""
    with new_bag(path, storage) as bag:
        events = [
            (time + round((late or {}).get(topic.topic, 0.0) * NANOSECONDS), rank, topic, message)
            for time, rank, topic, message in merged(bag, recording, None, block)
        ]
        for time, _, topic, message in sorted(events, key=lambda event: event[:2]):
            bag.write(topic, time, message)


@dataclass(frozen=True)
class SlowColumns:
    features: np.ndarray
    inside_range: np.ndarray
    status: np.ndarray
    uncertainty: np.ndarray
    ordinary = False

    def take(self, rows):
        return SlowColumns(*(column[rows] for column in vars(self).values()))


def run(path, calibration):
    """Return the result of all windows of a bag as one."""
    with open_bag(path) as bag:
        found = BagTopics(bag, path, NAMES)
        return joined(
            [part.result for _, part in OfflineRun(bag, path, found, calibration, found.read).windows() if part]
        )


def assert_same_bits(one, other):
    for name in Compensated.FIELDS:
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name


@pytest.fixture
def small_windows(monkeypatch):
    monkeypatch.setattr(message_batches, "BATCH", 4000)
    monkeypatch.setattr("hgma_compensation.recording.mcap_bulk_writer.CHUNK", 9000)
    monkeypatch.setattr(look_ahead, "LONGEST", 3 * NANOSECONDS)
    monkeypatch.setattr(offline_run, "PIECE", 1000)


@pytest.mark.parametrize("storage", list(Storage))
@pytest.mark.parametrize("mode", list(FilterMode))
@pytest.mark.parametrize("late", [0.0, 55.0])
def test_windows_give_the_bits_of_the_whole_recording(tmp_path, small_windows, storage, mode, late):
    values = RECORDING.values.copy()
    values[[7, 500, 501], 1] = np.nan, np.inf, 1e12
    broken = replace(RECORDING, values=values)
    write(tmp_path / "bag", broken, {"/accel/temperature": late}, storage=storage)
    calibration = make_calibration(mode=mode)
    assert_same_bits(run(tmp_path / "bag", calibration), compensate_recording(broken, calibration))


@pytest.mark.parametrize("block", [1, 30])
def test_effects_of_all_inputs_are_those_of_the_whole_recording(tmp_path, small_windows, block):
    random = np.random.default_rng(1)
    recording = with_all_inputs()
    effects = [applied(LINEAR[2], effect, random) for effect in OFFERED[LINEAR[2]]]
    calibration = make_calibration(channels=LINEAR[2:], effects=effects, mode=FilterMode.SMOOTH)
    late = {"/accel/temperature": 3.0, "/accel/temperature_2": 20.0, "/accel/supply_voltage": 40.0}
    write(tmp_path / "bag", recording, late, block)
    read = read_recording(tmp_path / "bag")
    assert_same_bits(run(tmp_path / "bag", calibration), compensate_recording(read, calibration))


@pytest.mark.parametrize("late", [-2.0, 0.0, 2.0])
def test_a_recording_of_several_rounds_is_compensated_round_by_round(tmp_path, small_windows, late):
    calibration = make_calibration(mode=FilterMode.SMOOTH)
    with new_bag(tmp_path / "bag") as bag:
        once = list(merged(bag, RECORDING, None, 1))
        rounds = [
            (time + n * 130 * NANOSECONDS + round(late * NANOSECONDS) * (topic.topic != "/accel/raw"), topic, message)
            for n in range(3)
            for time, _, topic, message in once
        ]
        for time, topic, message in sorted(rounds, key=lambda event: event[0]):
            bag.write(topic, time, message)
    result, expected = run(tmp_path / "bag", calibration), compensate_recording(RECORDING, calibration)
    for name in Compensated.FIELDS:
        assert getattr(result, name).tobytes() == 3 * getattr(expected, name).tobytes(), name


def test_what_comes_before_a_clock_is_set_back_belongs_to_the_clock_that_was(tmp_path):
    """Both streams are stamped by a clock that is set back by 20 s at 80 s."""
    calibration = make_calibration()
    turned, back = EPOCH + 80 * NANOSECONDS, 20 * NANOSECONDS
    with new_bag(tmp_path / "bag") as bag:
        for time, _, topic, message in list(merged(bag, RECORDING, None, 1)):
            if time >= turned:
                message.header.stamp.sec -= back // NANOSECONDS
            bag.write(topic, time, message)
    result, steady = run(tmp_path / "bag", calibration), compensate_recording(RECORDING, calibration)
    before = slice(0, 80 * 20)
    assert result.values[before].tobytes() == steady.values[before].tobytes()
    # Read whole, the slow inputs have been moved to the new clock before any acceleration is looked at.
    whole = compensate_recording(read_recording(tmp_path / "bag"), calibration)
    assert np.abs(whole.drift[before] - steady.drift[before]).max() > 1.0
    after = slice(85 * 20, None)
    np.testing.assert_allclose(result.drift[after], steady.drift[after], atol=0.1)


def test_history_and_messages_that_are_held_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(offline_run, "LAG", 100.0)
    monkeypatch.setattr(message_batches, "BATCH", 4000)
    monkeypatch.setattr("hgma_compensation.recording.mcap_bulk_writer.CHUNK", 9000)
    long = make_recording(duration_s=4000.0, accel_rate=2.0, thermistor_rate=2.0, cycles=2.0)
    write_recording(long, tmp_path / "bag")
    calibration = make_calibration()
    held = []
    with open_bag(tmp_path / "bag") as bag:
        found = BagTopics(bag, tmp_path / "bag", NAMES)
        going = OfflineRun(bag, tmp_path / "bag", found, calibration, found.read)
        for _ in going.windows():
            held.append(len(going._pipeline.track.updates))
    # A table of updates drops the old ones as it has to grow, from 256 rows on: twice what is needed at the most.
    assert max(held) <= 1024 < len(long.temperature.stamps)
    assert_same_bits(run(tmp_path / "bag", calibration), compensate_recording(long, calibration))


class Listening:
    """A feed that says how far it was read ahead of what was handed out."""

    def __init__(self):
        self.taken = 0

    def sets_back(self, part):
        return False

    def take(self, part):
        self.taken += len(part.batch)


def test_fast_blocks_are_held_up_to_a_number_of_bytes(monkeypatch):
    monkeypatch.setattr(look_ahead, "MOST_HELD", 1000)
    batches = [message_batches.Batch.of_messages([0], [n], [bytes(100)]) for n in range(50)]
    feed = Listening()
    ahead = []
    parts = (look_ahead.Held(batch, (), steps_back=False) for batch in batches)
    for number, _ in enumerate(look_ahead.behind(parts, feed)):
        ahead.append(feed.taken - number)
    assert len(ahead) == 50
    assert max(ahead) == 11


@given(
    times=st.lists(st.integers(0, 2000), min_size=1, max_size=30).map(sorted),
    slow=st.lists(st.tuples(st.integers(0, 29), st.integers(0, 200)), min_size=1, max_size=12),
)
def test_parts_of_a_batch_are_the_batch(times, slow):
    batch = message_batches.Batch.of_messages([0] * len(times), [t * NANOSECONDS for t in times], [b"x"] * len(times))
    rows = np.unique([row % len(times) for row, _ in slow])
    stamps = np.array([stamp for _, stamp in slow][: len(rows)]) * NANOSECONDS
    series = Series(stamps, np.arange(len(rows), dtype=float))
    cut = list(look_ahead.parts(batch, [look_ahead.Slow(None, series, rows)], {}))
    assert np.concatenate([part.batch.times for part in cut]).tolist() == batch.times.tolist()
    given_back = [one for part in cut for one in part.slow]
    assert np.concatenate([one.series.stamps for one in given_back]).tolist() == stamps.tolist()
    assert all(np.ptp(part.batch.times) < look_ahead.LONGEST for part in cut)
    steps = np.flatnonzero(np.diff(stamps) <= -5 * NANOSECONDS) + 1
    firsts = [one.series.stamps[0] for part in cut for one in part.slow if part.steps_back]
    assert firsts == stamps[steps].tolist()


@given(
    channels=st.lists(st.sampled_from(CHANNELS), min_size=1, max_size=6, unique=True),
    frame=st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=20),
    seed=st.integers(0, 1000),
)
@settings(max_examples=50)
def test_rows_of_states_are_the_serialised_messages(channels, frame, seed):
    random, count = np.random.default_rng(seed), 5
    calibration = make_calibration(channels=tuple(c for c in CHANNELS if c in channels), mode=FilterMode.BIAS)
    wide = [random.standard_normal((count, len(channels))) for _ in range(4)]
    wide[1][0, 0], wide[2][1, 0] = np.nan, -0.0
    status, inside = random.integers(0, 6, count).astype(np.uint8), random.integers(0, 2, count).astype(bool)
    slow = SlowColumns(random.standard_normal((count, 3)), inside, status, wide[3])
    result = Compensated(wide[0], wide[0], slow, drift=wide[1], innovation=wide[2])
    heads = random.integers(0, 256, (2, 8)).astype(np.uint8)
    rows = StateRows(calibration, frame).rows(heads, result.take(np.array([1, 4])))
    store = types.typestore()
    for row, head, sample in zip(rows, heads, (1, 4), strict=True):
        stamp = store.types["builtin_interfaces/msg/Time"](
            *(int(head[a : a + 4].view(kind)[0]) for a, kind in ((0, "<i4"), (4, "<u4")))
        )
        message = store.types[types.STATE](
            header=store.types["std_msgs/msg/Header"](stamp, frame), **state_fields(calibration, result, sample)
        )
        assert row.tobytes() == bytes(store.serialize_cdr(message, types.STATE))


def outputs(path):
    with open_bag(path) as bag:
        return [(c.topic, time, raw) for c, time, raw in read_messages(bag, path, []) if "/accel/" in c.topic]


@pytest.mark.parametrize("block", [1, 30])
def test_messages_of_no_known_layout_are_compensated_alike(tmp_path, monkeypatch, block):
    write(tmp_path / "bag", RECORDING, block=block)
    calibration = make_calibration(mode=FilterMode.SMOOTH)
    write_compensated(tmp_path / "bag", calibration, tmp_path / "fast", names=NAMES)
    with monkeypatch.context() as patched:
        patched.setattr(ImuBatch, "of_rows", lambda rows: None)
        patched.setattr(accelerations, "batches", lambda raws: ((slice(n, n + 1), None) for n in range(len(raws))))
        patched.setattr("hgma_compensation.cdr.block.BlockView.of", lambda raw: None)
        patched.setattr("hgma_compensation.recording.slow_inputs.scalar_columns", lambda rows, doubles: None)
        write_compensated(tmp_path / "bag", calibration, tmp_path / "slow", names=NAMES)
    assert outputs(tmp_path / "fast") == outputs(tmp_path / "slow")


def test_frames_that_alternate_are_kept_in_every_output(tmp_path):
    with new_bag(tmp_path / "bag") as bag:
        for number, (time, _, topic, message) in enumerate(merged(bag, RECORDING, None, 1)):
            message.header.frame_id = ("imu", "a longer frame", "ümu")[number // 3 % 3]
            bag.write(topic, time, message)
    write_compensated(tmp_path / "bag", make_calibration(), tmp_path / "out", names=NAMES, state_rate=0.0)
    store, frames = types.typestore(), {}
    for topic, _, raw in outputs(tmp_path / "out"):
        kind = {"/accel/raw": types.IMU, "/accel/compensated": types.IMU, "/accel/state": types.STATE}.get(topic)
        if kind is not None:
            frames.setdefault(topic, []).append(store.deserialize_cdr(raw, kind).header.frame_id)
    assert frames["/accel/raw"] == frames["/accel/compensated"] == frames["/accel/state"]
    assert len(set(frames["/accel/raw"])) == 3


@pytest.mark.parametrize("rate", [0.0, 1.0, 5.0])
def test_states_are_those_that_the_rate_chooses(tmp_path, small_windows, rate):
    write(tmp_path / "bag", RECORDING)
    calibration = make_calibration()
    write_compensated(tmp_path / "bag", calibration, tmp_path / "out", names=NAMES, state_rate=rate)
    expected = compensate_recording(RECORDING, calibration)
    rows = StateRate(rate).choose(RECORDING.stamps, expected.status, expected.inside_range)
    states = [
        types.typestore().deserialize_cdr(raw, types.STATE)
        for topic, _, raw in outputs(tmp_path / "out")
        if topic == "/accel/state"
    ]
    stamps = [state.header.stamp.sec * NANOSECONDS + state.header.stamp.nanosec for state in states]
    assert stamps == RECORDING.stamps[rows].tolist()
    assert [state.drift.tolist() for state in states] == expected.drift[rows].tolist()
    assert 0 < len(rows) <= len(RECORDING.stamps)


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        ({"temperature": Series.empty()}, "holds no thermistor sample"),
        ({"values": RECORDING.values * np.array([1, 1, 0, 0, 0, 0])}, r"no channel linear_acceleration\.z"),
    ],
)
def test_what_the_calibration_needs_and_the_bag_lacks_is_refused_and_nothing_is_left(tmp_path, spoil, reason):
    write_recording(replace(RECORDING, **spoil), tmp_path / "bag")
    with pytest.raises(RefusedError, match=reason):
        write_compensated(tmp_path / "bag", make_calibration(), tmp_path / "out", names=NAMES)
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def test_outputs_that_the_bag_has_already_are_replaced(tmp_path):
    write_recording(RECORDING, tmp_path / "bag")
    first, second = make_calibration(seed=1), make_calibration(seed=9)
    write_compensated(tmp_path / "bag", first, tmp_path / "first", names=NAMES)
    write_compensated(tmp_path / "first", second, tmp_path / "again", names=NAMES)
    write_compensated(tmp_path / "bag", second, tmp_path / "second", names=NAMES)
    assert outputs(tmp_path / "again") == outputs(tmp_path / "second")


def test_pieces_of_blocks_are_the_batch_and_bounded(monkeypatch, tmp_path):
    monkeypatch.setattr(offline_run, "PIECE", 1000)
    write(tmp_path / "bag", RECORDING, block=30)
    with open_bag(tmp_path / "bag") as bag:
        found = BagTopics(bag, tmp_path / "bag", NAMES)
        whole = [raw for batch in bag.batches(found.read) for raw in batch.raws()]
        windows = OfflineRun(bag, tmp_path / "bag", found, make_calibration(), found.read).windows()
        pieces = [batch.raws() for batch, _ in windows]
    assert [raw for piece in pieces for raw in piece] == whole
    assert len(pieces) > 10
    assert max(sum(map(len, piece[1:])) for piece in pieces) < 1000
