"""Serialised samples that are read and patched in place, against the same messages taken as objects, one by one."""

import numpy as np
import pytest
from builders import EPOCH, make_calibration
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import serialize_message
from robot import imu, stamped

from hgma_compensation.cdr.header import aligned, read_header
from hgma_compensation.channels import CHANNELS
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.node.admission import Admission
from hgma_compensation.node.block_stream import BlockStream
from hgma_compensation.node.imu_stream import ImuStream
from hgma_compensation.node.outputs import States
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.status import UNUSABLE
from hgma_msgs.msg import AccelBlock

pytestmark = pytest.mark.ros

ACCELERATION = make_calibration(mode=FilterMode.SMOOTH)
BOTH = make_calibration(channels=(CHANNELS[2], CHANNELS[3], CHANNELS[0]))
CALIBRATIONS = [None, ACCELERATION, BOTH]
FRAMES = st.sampled_from(["imu_link", "imu_link", "imu_link", "other", "", "Übung"])
NUMBERS = st.one_of(st.floats(-50.0, 50.0), st.sampled_from([0.0, -0.0, 9.81, float("nan"), float("inf"), 1e7, -1e300]))
COVARIANCES = st.sampled_from(
    [[0.0] * 9, [-1.0] + [0.0] * 8, [0.1 * n for n in range(9)], [float("nan")] * 9, [0.0] * 4 + [-2.0] + [0.0] * 4]
)
STEPS = st.one_of(st.just(10_000_000), st.sampled_from([0, 1, -5_000_000, 3_000_000_000, -200_000_000_000]))


class Sink:
    """A publisher that keeps what it is given."""

    is_activated = True

    def __init__(self):
        self.sent = []
        self.handle = self

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def publish_raw(self, raw):
        header = read_header(raw)
        # What fills the gap to the first double is whatever the serialiser's buffer held.
        self.sent.append(raw[: header.end] + raw[aligned(header.end) :])

    def publish(self, message):
        self.sent.append({name: plain(getattr(message, name)) for name in message.get_fields_and_field_types()})


def plain(value):
    """Return a field so that it compares by what it holds, bit for bit."""
    return value.tobytes() if isinstance(value, np.ndarray) else repr(value)


class Node:
    """What a node has of one kind of stream, without a node."""

    def __init__(self, kind, calibration, *, frame="", stop=False, rate=20.0):
        self.live = LiveCompensation()
        if calibration is not None:
            self.live.install(calibration)
        self.live.stop_on = UNUSABLE if stop else frozenset()
        for second in range(-60, 1):
            self.live.add_temperature(EPOCH + second * 10**9, 25.0 + 0.01 * (second % 3))
        self.outputs, self.states, states = Sink(), Sink(), States(rate)
        states.open(self.states)
        self.admission = Admission(self.live, frame, states.reset)
        self.admission.publishing = True
        self.stream = kind(self.live, self.admission, self.outputs, states)

    def all(self):
        live = self.live
        return self.outputs.sent, self.states.sent, dict(live.counts), live.received, live.compensated


@st.composite
def imus(draw):
    """Draw serialised messages in their order, some of them damaged."""
    raws, stamp = [], EPOCH
    for _ in range(draw(st.integers(1, 12))):
        stamp += draw(STEPS)
        message = imu(stamp, draw(st.lists(NUMBERS, min_size=6, max_size=6)), draw(FRAMES))
        message.orientation.w = draw(NUMBERS)
        for group in ("linear_acceleration", "angular_velocity", "orientation"):
            setattr(message, f"{group}_covariance", draw(COVARIANCES))
        raws.append(damaged(draw, bytes(serialize_message(message))))
    return raws


@st.composite
def blocks(draw):
    """Draw serialised blocks in their order, some of them malformed or damaged."""
    raws, stamp = [], EPOCH
    for _ in range(draw(st.integers(1, 6))):
        count = draw(st.integers(0, 5))
        axes = [draw(st.lists(st.floats(-50.0, 50.0, width=32), min_size=count, max_size=count)) for _ in "xyz"]
        axes[1] = axes[1] + draw(st.sampled_from([[], [], [], [], [1.0]]))
        interval = draw(st.sampled_from([0.001, 0.001, 0.02, 0.0, float("nan"), -1.0]))
        message = stamped(AccelBlock(sample_interval=interval, x=axes[0], y=axes[1], z=axes[2]), stamp, draw(FRAMES))
        stamp += draw(STEPS)
        raws.append(damaged(draw, bytes(serialize_message(message))))
    return raws


def damaged(draw, raw):
    """Return a message mostly as it is, else cut off, with bytes behind it, or of another encapsulation."""
    kind = draw(st.sampled_from(["whole"] * 12 + ["short", "long", "other", "empty"]))
    return {"whole": raw, "short": raw[:-5], "long": raw + b"\x00" * 3, "other": b"\x00\x03" + raw[2:], "empty": b""}[
        kind
    ]


def split(draw, raws):
    """Draw how messages come together."""
    cuts = sorted(draw(st.lists(st.integers(0, len(raws)), max_size=4)))
    return [raws[a:b] for a, b in zip([0, *cuts], [*cuts, len(raws)], strict=True)]


OPTIONS = st.fixed_dictionaries(
    {"frame": st.sampled_from(["", "imu_link"]), "stop": st.booleans(), "rate": st.sampled_from([20.0, 0.0])}
)


@given(imus(), st.sampled_from(CALIBRATIONS), OPTIONS, st.data())
def test_imus_in_place_are_what_they_are_as_objects(raws, calibration, options, data):
    in_place, objects = (Node(ImuStream, calibration, **options) for _ in range(2))
    for part in split(data.draw, raws):
        in_place.stream.take(part)
    for raw in raws:
        objects.stream._take_message(raw)
    assert in_place.all() == objects.all()
    assert in_place.live.received == len(raws)


PLAIN = [
    make_calibration(),
    make_calibration(channels=CHANNELS[:3]),
    make_calibration(channels=(CHANNELS[0], CHANNELS[2])),
    make_calibration(channels=(CHANNELS[2], CHANNELS[1])),
    make_calibration(channels=CHANNELS[1:4]),
]
"""Without filter: in order, with a gap between them, in another order, with a channel that blocks lack."""

ODD = st.sampled_from([None] * 12 + [float("nan"), float("-inf"), 6e5, 2e6, -0.0])


@st.composite
def streams(draw):
    """Draw blocks of one length that follow one another, nearly always, and thermistor samples between them."""
    count, interval = draw(st.sampled_from([(1, 0.001), (40, 0.001), (700, 1e-5), (300, 0.004), (20_500, 1e-6)]))
    random = np.random.default_rng(draw(st.integers(0, 9)))
    stamp, said = EPOCH + draw(st.integers(0, 10**9)), []
    for _ in range(draw(st.integers(3, 10))):
        axes = random.normal(0.0, 5.0, (3, count)).astype(np.float32)
        if (odd := draw(ODD)) is not None:
            axes[draw(st.integers(0, 2)), draw(st.integers(0, count - 1))] = odd
        message = stamped(AccelBlock(sample_interval=interval, x=axes[0], y=axes[1], z=axes[2]), stamp, "imu_link")
        said.append(bytes(serialize_message(message)))
        for late in draw(st.lists(st.sampled_from([0, 1, 900_000_000, -4_000_000_000]), max_size=2)):
            said.append((stamp - late, 25.0 + draw(st.sampled_from([0.0, 0.01, 80.0, float("nan")]))))
        stamp += round(count * interval * 1e9) + draw(st.sampled_from([0] * 12 + [1, -1, 6_000_000_000, -7 * 10**9]))
    return said


@given(streams(), st.sampled_from(PLAIN), OPTIONS)
def test_blocks_that_only_go_on_are_what_they_are_as_objects(said, calibration, options):
    in_place, objects = (Node(BlockStream, calibration, **options) for _ in range(2))
    for one in said:
        if isinstance(one, bytes):
            in_place.stream.take([one])
            objects.stream._take_message(one)
        else:
            in_place.live.add_temperature(*one)
            objects.live.add_temperature(*one)
    assert in_place.all() == objects.all()
    last, other = (node.live.last_result for node in (in_place, objects))
    if last is not None:
        for name in ("values", "drift", "features", "status", "inside_range", "uncertainty"):
            assert getattr(last.compensated, name)[-1].tobytes() == getattr(other.compensated, name)[-1].tobytes()


def test_blocks_that_only_go_on_are_taken_without_a_second_look(monkeypatch):
    node = Node(BlockStream, make_calibration(channels=CHANNELS[:3]))
    sent = []
    for number in range(30):
        axes = np.full((3, 100), 0.1 * number, dtype=np.float32)
        message = stamped(AccelBlock(sample_interval=0.001, x=axes[0], y=axes[1], z=axes[2]), EPOCH + number * 10**8)
        sent.append(bytes(serialize_message(message)))
    node.stream.take(sent[:1])
    monkeypatch.setattr(node.live, "compensate", None)
    node.stream.take(sent[1:])
    assert len(node.outputs.sent) == node.live.compensated // 100 == 30


@given(blocks(), st.sampled_from(CALIBRATIONS), OPTIONS)
def test_blocks_in_place_are_what_they_are_as_objects(raws, calibration, options):
    in_place, objects = (Node(BlockStream, calibration, **options) for _ in range(2))
    in_place.stream.take(raws)
    for raw in raws:
        objects.stream._take_message(raw)
    assert in_place.all() == objects.all()


def test_an_ordinary_stream_is_patched_in_place():
    """So that the two tests above do not compare the ordinary path with itself."""
    for kind, message in ((ImuStream, imu(EPOCH, [1.0] * 6)), (BlockStream, AccelBlock(sample_interval=1.0, x=[1.0]))):
        node = Node(kind, ACCELERATION)
        node.stream._take_message = None
        if kind is BlockStream:
            message = stamped(AccelBlock(sample_interval=0.1, x=[1.0], y=[2.0], z=[3.0]), EPOCH)
        raw = bytes(serialize_message(message))
        node.stream.take([raw])
        node.stream.take([raw, raw])
        assert len(node.outputs.sent) == 3


def test_a_node_that_is_not_active_counts_what_it_skips():
    for kind, message, samples in (
        (ImuStream, imu(EPOCH, [1.0] * 6), 1),
        (BlockStream, stamped(AccelBlock(sample_interval=0.1, x=[1.0] * 3, y=[1.0] * 3, z=[1.0] * 3), EPOCH), 3),
    ):
        node = Node(kind, ACCELERATION)
        node.admission.publishing = False
        raws = [bytes(serialize_message(message))] * 2
        assert node.stream.take(raws) == EPOCH
        assert node.stream.take(raws[:1]) == EPOCH
        assert node.live.counts == {"node_not_active": 3 * samples}
        assert not node.outputs.sent


def test_what_cannot_be_read_is_counted_and_has_no_stamp():
    for kind in (ImuStream, BlockStream):
        node = Node(kind, ACCELERATION)
        assert node.stream.take([b"", b"nothing of the kind"]) is None
        assert node.live.counts == {"acceleration_unreadable": 2}
        assert node.live.received == node.live.skipped() == 2
