"""What saving costs the stream: ``python -m benchmarks.soak.saving_stall``.

One thread compensates a sample each millisecond, as the node's executor does; the longest time between a sample's due
moment and its end is taken in each second, in seconds with a save and in seconds without, by turns.
"""

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.soak.remembering import remembering_calibration, temperature
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.live_samples import single_sample
from hgma_compensation.pipeline.state_saver import StateSaver
from hgma_compensation.stamps import NANOSECONDS

RATE = 1000
HISTORY = 36 * 3600
"""s of thermistor samples at 1 Hz before the measurement: all that is remembered is then full."""

LONGEST = 0.02
"""s by which a save may hold a sample up beyond what the machine does: a fiftieth of the queue."""


def prepared() -> LiveCompensation:
    """Return a compensation with a day of history."""
    live = LiveCompensation()
    live.install(remembering_calibration())
    for second in range(-HISTORY, 0):
        live.add_temperature(second * NANOSECONDS, temperature(second % 300 - 300.0))
    return live


def measure(seconds: int, folder: Path) -> dict[str, dict[str, float]]:
    """Return, with saves and without, the longest delay of a sample in a second: least, median and greatest, ms."""
    live, saver = prepared(), StateSaver(folder / "state.json")
    longest: dict[bool, list[float]] = {True: [], False: []}
    for second in range(seconds):
        delays, due = [], time.monotonic()
        for number in range(RATE):
            # From the sample before: on a busy machine delays would add up.
            due = max(due + 1.0 / RATE, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))
            live.compensate(*single_sample(second * NANOSECONDS + number * NANOSECONDS // RATE, np.zeros(6).tolist()))
            if number == 100 and second % 2:
                saver.save(live.snapshot())
            delays.append(time.monotonic() - due)
        live.add_temperature((second + 1) * NANOSECONDS, temperature(second))
        longest[bool(second % 2)].append(1e3 * max(delays))
    saver.wait(10.0)
    assert saver.saves
    names = {True: "with_save", False: "without"}
    return {
        names[k]: {"least_ms": min(v), "median_ms": float(np.median(v)), "greatest_ms": max(v)}
        for k, v in longest.items()
    }


def main() -> int:
    """Print the figures as one line of JSON, and return 1 where a save holds the stream up for too long."""
    with tempfile.TemporaryDirectory() as folder:
        figures = measure(40, Path(folder))
    print(json.dumps(figures))
    # The quietest second of each kind: on a busy machine the others tell of the machine.
    added = figures["with_save"]["least_ms"] - figures["without"]["least_ms"]
    return 0 if added <= 1e3 * LONGEST else 1


if __name__ == "__main__":
    sys.exit(main())
