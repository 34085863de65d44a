"""Recordings streamed through a LiveCompensation that is stopped and started again with what its file held."""

import numpy as np

from hgma_compensation.effects.effect import Need
from hgma_compensation.pipeline.live import LiveCompensation
from hgma_compensation.pipeline.state_file import encode_bytes, parse_state


def arrivals(recording):
    """Return all slow samples as (stamp, input, value), in the order of their stamps."""
    inputs = {
        "temperature": recording.temperature,
        Need.TEMPERATURE_2.value: recording.temperature_2,
        Need.SUPPLY_VOLTAGE.value: recording.supply_voltage,
    }
    return sorted(
        (stamp, name, value)
        for name, series in inputs.items()
        for stamp, value in zip(series.stamps.tolist(), series.values.tolist(), strict=True)
    )


def file_of(live):
    """Return the bytes of the state file."""
    return encode_bytes(live.snapshot(), lambda: None)


def started(calibration, content=None, max_age=1e6):
    """Return a LiveCompensation as a node makes it: with a calibration, and the content of a state file if any."""
    live = LiveCompensation()
    live.install(calibration)
    if content is not None:
        live.offer(parse_state(content), max_age)
    return live


class Stream:
    """A recording on its way; slow samples come before the accelerations that are not older than they."""

    def __init__(self, recording):
        self._recording, self._waiting, self._row = recording, arrivals(recording), 0

    def send(self, live, stop):
        """Give a LiveCompensation everything up to a row of the accelerometer, and return the drift (n, c)."""
        rows, self._row = slice(self._row, stop), stop
        stamps = self._recording.stamps[rows]
        if not len(stamps):
            return np.empty((0, len(live.calibration.names)))
        while self._waiting and self._waiting[0][0] <= stamps[-1]:
            stamp, name, value = self._waiting.pop(0)
            getattr(live, f"add_{name}")(stamp, value)
        return live.compensate(stamps, self._recording.values[rows]).compensated.drift
