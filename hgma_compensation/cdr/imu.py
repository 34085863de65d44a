"""Serialised sensor_msgs/Imu messages, many at a time.

After the header an Imu is doubles only: orientation (4), its covariance (9), then for the angular velocity and for the
linear acceleration the three axes and a covariance (9), row by row.
"""

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.cdr.header import Header, aligned, read_header, read_stamps
from hgma_compensation.cdr.rows import FLOAT64, fields, stacked
from hgma_compensation.channels import AXES, CHANNELS, group_of

DOUBLES = 37
_BODY_SIZE = DOUBLES * FLOAT64.itemsize
# The first of the doubles of each group; its covariance follows the axes.
_GROUP_AT = {"angular_velocity": 13, "linear_acceleration": 25}
COVARIANCE_AT = {group: at + len(AXES) for group, at in _GROUP_AT.items()}
_CHANNEL_AT = {channel: _GROUP_AT[group_of(channel)] + AXES.index(channel[-1]) for channel in CHANNELS}
VALUES_AT = np.array([_CHANNEL_AT[channel] for channel in CHANNELS])


class ImuBatch:
    """Messages of one layout: the same size and frame.

    frame: frame_id. stamps: (n,) in ns. values: (n, 6) in the order of CHANNELS, on memory of their own.
    """

    def __init__(self, header: Header, rows: NDArray[np.uint8]) -> None:
        """Take messages (n, size) that all begin with the header and have the size of an Imu with it."""
        self.frame = header.frame
        self.stamps = read_stamps(rows)
        self._rows = rows
        self._start = aligned(header.end)
        self._body = self._doubles(rows)
        self.values: NDArray[np.float64] = self._body.take(VALUES_AT, axis=1).astype(np.float64, copy=False)
        self._valid: dict[str, NDArray[np.bool_]] = {}

    @classmethod
    def of_rows(cls, rows: NDArray[np.uint8]) -> "ImuBatch | None":
        """Return messages (n, size), C-contiguous, as a batch, which keeps them: they must not change.

        Returns:
            None where the layout is not recognised or not the same in all messages, and where there is none.
        """
        header = read_imu_header(rows[0].data) if len(rows) else None
        if header is None or not header.begins_all(rows):
            return None
        return cls(header, rows)

    def absent(self, group: str) -> NDArray[np.bool_]:
        """Return which messages (n,) declare the field absent by -1 in its covariance (REP-145)."""
        return np.asarray(self._body[:, COVARIANCE_AT[group]] == -1.0)

    def covariances_valid(self, groups: Iterable[str]) -> NDArray[np.bool_]:
        """Return in which messages (n,) the covariances of all these fields are valid.

        That is finite, with no negative variance, as ``patch_covariances`` judges.
        """
        valid = np.ones(len(self._rows), dtype=np.bool_)
        for group in groups:
            valid &= self._group_valid(group)
        return valid

    def _group_valid(self, group: str) -> NDArray[np.bool_]:
        if group not in self._valid:
            covariances = _covariances(self._body, group)
            variances = covariances[:, :: len(AXES) + 1]
            finite = np.isfinite(covariances).all(axis=1)
            self._valid[group] = np.asarray(finite & (variances >= 0.0).all(axis=1))
        return self._valid[group]

    def patched(
        self,
        rows: NDArray[np.int64] | slice,
        channels: Sequence[str],
        values: NDArray[np.float64],
        variances: NDArray[np.float64] | None,
    ) -> NDArray[np.uint8]:
        """Return copies (m, size) of some messages with channels overwritten and variances added.

        Equal to ``patch_imu`` and ``patch_covariances`` of ``hgma_compensation.messages``: a covariance of a field
        that a channel belongs to becomes the unknown one where it is invalid; every other byte stays as it is.

        Args:
            rows: Which messages.
            channels: Names of the channels (c).
            values: What they become, (m, c).
            variances: What is added to their variances, (m, c). A message whose variances are all NaN has nothing
                added, as the ordinary path's None; None is that for all messages.
        """
        # Indexing by an array copies, by a slice it does not.
        patched = self._rows[rows].copy() if isinstance(rows, slice) else self._rows[rows]
        body = self._doubles(patched)
        for column, channel in enumerate(channels):
            body[:, _CHANNEL_AT[channel]] = values[:, column]
        for group, diagonal in diagonals(tuple(channels)):
            valid = self._group_valid(group)[rows]
            if not valid.all():
                _covariances(body, group)[~valid] = 0.0
            if variances is not None:
                _add_variances(_covariances(body, group), diagonal, variances)
        return patched

    def _doubles(self, rows: NDArray[np.uint8]) -> NDArray[np.float64]:
        """Return the doubles (m, 37) of messages of this layout, on their memory."""
        return fields(rows, self._start, self._start + _BODY_SIZE, FLOAT64)


def _covariances(body: NDArray[np.float64], group: str) -> NDArray[np.float64]:
    start = COVARIANCE_AT[group]
    return body[:, start : start + len(AXES) ** 2]


def _add_variances(
    covariances: NDArray[np.float64], diagonal: Sequence[tuple[int, int]], variances: NDArray[np.float64]
) -> None:
    """Add columns of variances (m, c) at places of covariances (m, 9), but where a whole row of variances is NaN."""
    added = ~np.isnan(variances).all(axis=1)
    rows = slice(None) if added.all() else added  # of a slice numpy makes no copies
    for place, column in diagonal:
        covariances[rows, place] += variances[rows, column]


@lru_cache(maxsize=64)
def diagonals(channels: tuple[str, ...]) -> list[tuple[str, list[tuple[int, int]]]]:
    """Return for each field of the channels the places of their variances in its covariance, and their columns."""
    groups: dict[str, dict[int, int]] = {}
    for column, channel in enumerate(channels):
        axis = AXES.index(channel[-1])
        groups.setdefault(group_of(channel), {})[axis * (len(AXES) + 1)] = column
    return [(group, list(diagonal.items())) for group, diagonal in groups.items()]


def read_imu_header(raw: bytes | memoryview) -> Header | None:
    """Return the header of a serialised Imu, None where its layout is not recognised."""
    header = read_header(raw)
    return header if header is not None and len(raw) == aligned(header.end) + _BODY_SIZE else None


def batches(raws: Sequence[bytes]) -> Iterator[tuple[slice, ImuBatch | None]]:
    """Split consecutive serialised Imu messages into runs of one layout.

    Yields:
        The place of a run in raws, and its messages as a batch; None for a single message of no recognised layout.
    """
    start = 0
    while start < len(raws):
        header = read_imu_header(raws[start])
        stop = start + 1
        if header is None:
            yield slice(start, stop), None
        else:
            size = len(raws[start])
            while stop < len(raws) and len(raws[stop]) == size and header.begins(raws[stop]):
                stop += 1
            yield slice(start, stop), ImuBatch(header, stacked(raws[start:stop]))
        start = stop
