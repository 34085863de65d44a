"""Serialised hgma_msgs/CompensationState messages, many at a time."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.cdr.header import aligned
from hgma_compensation.cdr.rows import FLOAT64, fields
from hgma_compensation.pipeline.compensated import Compensated, zeros
from hgma_compensation.pipeline.state_fields import state_fields
from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.accelerations import STAMP_AT, STAMP_SIZE

_FRAME = STAMP_AT + STAMP_SIZE
_LENGTH = 4
"""Bytes of the length of a text or an array."""


class StateRows:
    """The states of one calibration for accelerations of one frame: all of the same size."""

    def __init__(self, calibration: Calibration, frame: str) -> None:
        """Lay a state out."""
        store, count = types.typestore(), len(calibration.names)
        header = store.types["std_msgs/msg/Header"](store.types["builtin_interfaces/msg/Time"](0, 0), frame)
        state = store.types[types.STATE](header=header, **state_fields(calibration, zeros(1, count), 0))
        self._template = np.frombuffer(bytes(store.serialize_cdr(state, types.STATE)), dtype=np.uint8)
        place = aligned(_FRAME + _LENGTH + len(frame.encode()) + 1)
        self._features = slice(place, place + 3 * FLOAT64.itemsize)
        place = self._features.stop + _LENGTH
        for name in calibration.names:
            place = aligned(place, _LENGTH) + _LENGTH + len(name.encode()) + 1
        self._arrays = []
        for _ in range(3):
            place = aligned(aligned(place, _LENGTH) + _LENGTH)
            self._arrays.append(slice(place, place + count * FLOAT64.itemsize))
            place = self._arrays[-1].stop
        self._inside = place

    def rows(self, heads: NDArray[np.uint8], result: Compensated) -> NDArray[np.uint8]:
        """Return the states (m, size) of samples; heads: (m, 8), their stamps as serialised."""
        made = np.tile(self._template, (len(heads), 1))
        made[:, STAMP_AT:_FRAME] = heads
        columns = (result.features, result.drift, result.uncertainty, result.innovation)
        for place, values in zip((self._features, *self._arrays), columns, strict=True):
            fields(made, place.start, place.stop, FLOAT64)[:] = values
        made[:, self._inside], made[:, self._inside + 1] = result.inside_range, result.status
        return made
