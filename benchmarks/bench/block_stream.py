"""The messages of the block rows, and a window of them in flight: what comes back makes room for the next."""

import time
from dataclasses import dataclass
from math import sqrt

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message

from benchmarks.bench.peer import Peer
from benchmarks.bench.samples import DENSITY, SEED, STILL
from benchmarks.bench.trials import no_garbage_collection
from benchmarks.soak.resident import processor_seconds
from benchmarks.soak.serialised import STAMP, STAMP_AT, stamp_of
from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import AccelBlock

SAMPLES, RATE = 10_000, 1e6
"""In a block, and Hz: the blocks follow one another without a gap, in time of the sensor."""

DURATION = round(SAMPLES / RATE * NANOSECONDS)
WINDOW = 4
"""Blocks in flight: enough that nobody waits, few enough that no queue of the middleware overflows."""

THERMISTOR_EVERY = 10
"""Blocks: 10 Hz in time of the sensor."""

POOL = 8
SILENCE = 2.0


class BlockStream:
    """Serialised blocks, numbered from 0 and stamped one after the other; each run begins after the one before."""

    def __init__(self) -> None:
        """Make a few blocks of noise, which are sent again and again."""
        random = np.random.default_rng(SEED)
        self._next = time.time_ns() // DURATION * DURATION
        self.sent = [self._block(random) for _ in range(POOL)]
        self._raw = [bytearray(serialize_message(message)) for message in self.sent]

    def message(self) -> tuple[int, bytes]:
        """Return the stamp of the next block in ns, and the block."""
        stamp, self._next = self._next, self._next + DURATION
        raw = self._raw[stamp // DURATION % POOL]
        STAMP.pack_into(raw, STAMP_AT, *divmod(stamp, NANOSECONDS))
        return stamp, bytes(raw)

    def changed(self, raw: bytes) -> bool:
        """Return whether every sample of a block that came back is another one; raises RuntimeError where some are."""
        message, sent = deserialize_message(raw, AccelBlock), self.sent[stamp_of(raw) // DURATION % POOL]
        same = [float(np.equal(getattr(message, axis), getattr(sent, axis)).mean()) for axis in "xyz"]
        if len(message.x) != SAMPLES or not (max(same) < 0.01 or min(same) == 1.0):
            raise RuntimeError("a block came back with some of its samples changed")
        return max(same) < 0.01

    @staticmethod
    def _block(random: np.random.Generator) -> AccelBlock:
        noise = DENSITY * sqrt(RATE) * random.standard_normal((3, SAMPLES)).astype(np.float32)
        x, y, z = noise + np.array([[0.0], [0.0], [STILL]], dtype=np.float32)
        message = AccelBlock(sample_interval=1.0 / RATE, x=x, y=y, z=z)
        message.header.frame_id = "imu_link"
        return message


@dataclass(frozen=True)
class BlockTrial:
    """rate: blocks/s that came through. lost: blocks. changed: whether the last one was compensated. cpu: s a block."""

    rate: float
    lost: int
    changed: bool
    cpu: float


def blocks_through(peer: Peer, pid: int, stream: BlockStream, seconds: float) -> BlockTrial:
    """Send blocks for a time in s, as fast as they come back; raises RuntimeError where nothing does."""
    came = lost = sent = 0
    heard: list[bytes] = []
    last = b""
    before, start = processor_seconds(pid), time.perf_counter()
    heard_at = start
    with no_garbage_collection():
        while (now := time.perf_counter()) - start < seconds or came + lost < sent:
            while sent - came - lost < WINDOW and now - start < seconds:
                stamp, message = stream.message()
                if sent % THERMISTOR_EVERY == 0:
                    peer.send_temperature(stamp)
                peer.send(message)
                sent += 1
            peer.wait(0.1)
            peer.take(heard)
            if heard:
                came, last, heard_at = came + len(heard), heard[-1], time.perf_counter()
                heard.clear()
            elif now - heard_at > SILENCE:
                lost, heard_at = sent - came, now
    if not came:
        raise RuntimeError("no block came back")
    elapsed = heard_at - start
    return BlockTrial(came / elapsed, lost, stream.changed(last), (processor_seconds(pid) - before) / came)
