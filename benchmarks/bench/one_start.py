"""One start beside a stream that runs already: ``python -m benchmarks.bench.one_start OURS AFTER COMMAND...``.

OURS: whether an answer must have been changed. AFTER: s after the first answer at which the memory is read. A process
of its own, because Fast DDS reads the profile of its participants once in a process.
"""

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from subprocess import Popen

from benchmarks.bench.imu_stream import ImuStream
from benchmarks.bench.messages import imu_peer
from benchmarks.bench.pace import send_evenly
from benchmarks.bench.peer import Peer
from benchmarks.bench.processes import peak_megabytes, started
from benchmarks.bench.trials import TIMEOUT
from benchmarks.soak.resident import processor_seconds

RATE, THERMISTOR_RATE = 1000.0, 100.0
"""Hz; a thermistor so fast that a node does not wait for it."""

SETTLED = 0.7
"""s that the source has run: longer than the half second in which Fast DDS announces a new participant often."""

PROFILE = "FASTRTPS_DEFAULT_PROFILES_FILE"

OFTEN = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="source" is_default_profile="true"><rtps><builtin><discovery_config>
    <leaseAnnouncement><sec>0</sec><nanosec>20000000</nanosec></leaseAnnouncement>
  </discovery_config></builtin></rtps></participant>
</profiles>
"""
"""A source that announces itself every 20 ms.

Fast DDS drops what a participant is sent before its creation has ended, which is when others answer its first
announcement; they do not answer again, and their own next one is up to 3 s away. Who starts cannot help it.
"""


@dataclass(frozen=True)
class Start:
    """seconds: to the first answer. processor: s of all threads until then. peak_megabytes: process and children."""

    seconds: float
    processor: float
    peak_megabytes: float


def main() -> int:
    """Start a command, print its figures as JSON; exit code 1 with the reason where there are none."""
    ours, after, *command = sys.argv[1:]
    try:
        start = measured(command, float(after), ours=ours == "True")
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 1
    print(json.dumps(asdict(start)))
    return 0


def measured(command: Sequence[str], after: float, *, ours: bool) -> Start:
    """Return the figures of a command's start; raises RuntimeError where it does not answer or ends badly."""
    start = None
    with imu_peer() as peer:
        os.environ.pop(PROFILE, None)  # what is started goes by the defaults
        source = Source(peer, changed=ours)
        source.run(SETTLED)
        begun = time.perf_counter()
        try:
            with started(command) as process:
                answered = source.first_answer(process)
                if answered is not None:
                    processor = processor_seconds(process.pid)
                    source.run(after)
                    start = Start(answered - begun, processor, peak_megabytes(process.pid))
        except RuntimeError:
            # A rival that rclpy lets down because SIGINT comes while a message is converted has been measured.
            if ours or start is None:
                raise
    if start is None:
        raise RuntimeError(f"no answer within {TIMEOUT:g} s")
    return start


class Source:
    """Accelerations and temperatures, sent all the time; what comes back is looked at."""

    def __init__(self, peer: Peer, *, changed: bool) -> None:
        """changed: what comes back as it was sent is no answer: a node without a temperature leaves it as it is."""
        self._peer, self._changed = peer, changed
        self._heard: list[bytes] = []
        self._answered: list[float] = []

    def run(self, seconds: float) -> None:
        """Stream for a time."""
        self._stream(seconds, lambda _: False)

    def first_answer(self, process: Popen[bytes]) -> float | None:
        """Stream until there is an answer; return when it came, on the clock of perf_counter.

        None where the process ends before that, or TIMEOUT does.
        """
        self._answered.clear()
        self._stream(TIMEOUT, lambda _: bool(self._answered) or process.poll() is not None)
        return self._answered[0] if self._answered else None

    def _stream(self, seconds: float, give_up: Callable[[int], bool]) -> None:
        stream = ImuStream(RATE, time.time_ns())

        def send(number: int) -> None:
            if number % round(RATE / THERMISTOR_RATE) == 0:
                self._peer.send_temperature(stream.stamp(number))
            self._peer.send(stream.message(number))

        def take() -> None:
            self._peer.take(self._heard)
            if self._heard and (not self._changed or stream.received(self._heard).changed):
                self._answered.append(time.perf_counter())
            self._heard.clear()

        if seconds:
            send_evenly(RATE, seconds, send, take, give_up=give_up)


def profile(folder: Path) -> dict[str, str]:
    """Return what the environment of such a process must have, after writing the profile into a folder."""
    path = folder / "often_announced.xml"
    path.write_text(OFTEN)
    return {PROFILE: str(path)}


if __name__ == "__main__":
    sys.exit(main())
