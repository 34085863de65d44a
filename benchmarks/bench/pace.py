"""Sending at an even pace, and how well that was kept."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

BURST = 1e-3
"""s of samples that are sent at once at most."""

LATEST = 0.25
"""s that the source may be behind at its end, or the answer to its last sample: more is a queue that grows."""

SLACK = 1e-4
"""s before a moment at which a sleep is given up: sleeping is not more exact."""


@dataclass(frozen=True)
class Pace:
    """sent: samples. late: s by which a burst came late, 99th percentile, and the last one. ended: s, perf_counter."""

    sent: int
    late_99: float
    late_end: float
    ended: float

    @property
    def kept(self) -> bool:
        """Return whether the source sent at the rate that it was told."""
        return self.late_end <= LATEST


def send_evenly(
    rate: float,
    seconds: float,
    send: Callable[[int], None],
    serve: Callable[[], None],
    *,
    give_up: Callable[[int], bool] = lambda sent: False,
) -> Pace:
    """Send samples 0, 1, ... at a rate in Hz for a time, and serve whatever comes back in between.

    A burst that comes late is made up for at twice the rate, so that the mean holds and no queue is flooded for what
    the machine did to the source. give_up: asked after each burst with the number sent so far, ends it.
    """
    tick = max(BURST, 1.0 / rate)
    sent, late = 0, []
    begun = start = time.perf_counter()
    for burst in range(round(seconds / tick)):
        due = start + burst * tick
        _wait(max(due, begun + 0.5 * tick), serve)
        begun = time.perf_counter()
        late.append(begun - due)
        end = round((burst + 1) * tick * rate)
        while sent < end:
            send(sent)
            sent += 1
        serve()
        if give_up(sent):
            break
    return Pace(sent, float(np.percentile(late, 99.0)), late[-1], time.perf_counter())


def _wait(due: float, serve: Callable[[], None]) -> None:
    """Serve until a moment is near, and sleep where nothing has to be done."""
    while (left := due - time.perf_counter()) > SLACK:
        time.sleep(min(left - SLACK, BURST))
        serve()
