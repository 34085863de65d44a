"""Trials of the message path: a stream through a process, at a rate, and what it cost."""

import gc
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from subprocess import Popen

import numpy as np
from numpy.typing import NDArray

from benchmarks.bench.imu_stream import ImuStream
from benchmarks.bench.pace import LATEST, send_evenly
from benchmarks.bench.peer import Peer
from benchmarks.soak.resident import processor_seconds
from hgma_compensation.stamps import NANOSECONDS

Array = NDArray[np.float64]
TIMEOUT = 60.0
"""s for a process to answer."""

SILENCE = 0.5
"""s without an answer after which what is missing is lost."""

WARM_UP, WARM_UP_RATE = 1.5, 200.0
THERMISTOR_RATE = 10.0
PAST = 70.0
"""s of the thermistor's past: more than the delay of its product."""


@dataclass(frozen=True)
class Trial:
    """rate: Hz. sent, lost: messages. changed: messages whose acceleration was changed on the way. cpu: s of all.

    source_kept: whether the source sent at that rate; source_late_99: s by which its bursts came late. behind: s from
    the last message's sending to the last answer's coming.
    """

    rate: float
    sent: int
    lost: int
    changed: int
    cpu: float
    source_kept: bool
    source_late_99: float
    behind: float

    @property
    def sustained(self) -> bool:
        """Return whether everything came back, and without a queue that grows."""
        return not self.lost and self.source_kept and self.behind <= LATEST

    @property
    def cpu_per_message(self) -> float:
        """Return s of processor time for each message that came through."""
        return self.cpu / max(self.sent - self.lost, 1)


def warm_up(peer: Peer, process: Popen[bytes]) -> None:
    """Wait until a process answers, tell it of the time before, and send for a while.

    With the thermistor's past a node is in the state in which it is nearly always: its features have settled. Raises
    RuntimeError where the process does not answer.
    """
    end = time.monotonic() + TIMEOUT
    heard: list[bytes] = []
    stream = ImuStream(WARM_UP_RATE, time.time_ns())

    def send(number: int) -> None:
        if number % round(WARM_UP_RATE / THERMISTOR_RATE) == 0:
            peer.send_temperature(stream.stamp(number))
        peer.send(stream.message(number))

    while not heard:
        if process.poll() is not None or time.monotonic() > end:
            raise RuntimeError(f"process {process.args!r} does not answer (exit code {process.returncode})")
        stream = ImuStream(WARM_UP_RATE, time.time_ns())
        _send_alone(peer, stream, heard)
    tell_past(peer, time.time_ns())
    peer.take(heard)
    stream = ImuStream(WARM_UP_RATE, time.time_ns())
    send_evenly(WARM_UP_RATE, WARM_UP, send, lambda: peer.take(heard))
    peer.forget()


def _send_alone(peer: Peer, stream: ImuStream, heard: list[bytes]) -> None:
    """Send accelerations for a moment, without a thermistor."""
    send_evenly(WARM_UP_RATE, 0.2, lambda number: peer.send(stream.message(number)), lambda: peer.take(heard))


def tell_past(peer: Peer, until: int) -> None:
    """Send what the thermistor showed before a stamp, ns."""
    step = round(NANOSECONDS / THERMISTOR_RATE)
    first = until - round(PAST * NANOSECONDS)
    send_evenly(
        1000.0,
        PAST * THERMISTOR_RATE / 1000.0,
        lambda number: peer.send_temperature(first + number * step),
        lambda: None,
    )


def stream_through(peer: Peer, process: Popen[bytes], rate: float, seconds: float) -> Trial:
    """Send at a rate in Hz for a time in s; ended early where more than a second's messages are on their way."""
    heard: list[bytes] = []
    stream = ImuStream(rate, time.time_ns())
    every = max(round(rate / THERMISTOR_RATE), 1)

    def send(number: int) -> None:
        if number % every == 0:
            peer.send_temperature(stream.stamp(number))
        peer.send(stream.message(number))

    with no_garbage_collection():
        before = processor_seconds(process.pid)
        pace = send_evenly(
            rate, seconds, send, lambda: peer.take(heard), give_up=lambda sent: sent - len(heard) > max(rate, 100.0)
        )
        last = _await_rest(peer, heard, pace.sent)
        cpu = processor_seconds(process.pid) - before
    received = stream.received(heard)
    return Trial(
        rate=rate,
        sent=pace.sent,
        lost=received.lost(pace.sent),
        changed=received.changed,
        cpu=cpu,
        source_kept=pace.kept,
        source_late_99=pace.late_99,
        behind=max(last - pace.ended, 0.0),
    )


def _await_rest(peer: Peer, heard: list[bytes], sent: int) -> float:
    """Take what is still on its way; return when the last message came, on the clock of perf_counter."""
    last = time.perf_counter()
    while len(heard) < sent and time.perf_counter() - last < SILENCE:
        before = len(heard)
        peer.wait(0.01)
        peer.take(heard)
        if len(heard) > before:
            last = time.perf_counter()
    return last


def latencies(peer: Peer, rate: float, seconds: float) -> Array:
    """Return the time (n,) in s from sending to receiving of each message that came back; waits, does not poll."""
    stream = ImuStream(rate, time.time_ns())
    every = max(round(rate / THERMISTOR_RATE), 1)
    sent_at: list[float] = []
    heard: list[bytes] = []
    heard_at: list[float] = []
    start = time.perf_counter()
    with no_garbage_collection():
        for number in range(round(seconds * rate)):
            if number % every == 0:
                peer.send_temperature(stream.stamp(number))
            message = stream.message(number)
            sent_at.append(time.perf_counter())
            peer.send(message)
            # An answer may come after the next message was sent: the slow ones count too.
            while (left := start + (number + 1) / rate - time.perf_counter()) > 0.0:
                peer.wait(left)
                peer.take(heard)
                heard_at += [time.perf_counter()] * (len(heard) - len(heard_at))
    if not heard:
        raise RuntimeError("no message came back")
    numbers = stream.received(heard).numbers
    return np.asarray(np.array(heard_at) - np.array(sent_at)[numbers])


@contextmanager
def no_garbage_collection() -> Iterator[None]:
    """Keep the collector from holding the source up in the middle of a trial."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
