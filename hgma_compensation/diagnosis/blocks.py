"""Means of a channel over blocks of time, shocks left out of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.diagnosis.runs import Run, power_on_before, since_power_on
from hgma_compensation.recording.sliced import Column, Sliced, in_parts
from hgma_compensation.stamps import Stamps, seconds_between

Array = NDArray[np.float64]

SETTLING = 10.0
"""s after a power-on that are not judged: the trend is not known yet."""

OUTLIER = 7.0
"""Robust deviations from a block's median beyond which a sample (a shock) is left out of its mean."""

MOST_AT_ONCE = 200_000
"""Samples whose blocks are formed together: what that takes of memory does not grow with the recording."""


@dataclass(frozen=True)
class Blocks:
    """Means over blocks of one channel, n of them, in the order of their runs.

    run: (n,). stamps: (n,) ns, mean of the samples'. values: (n,) means without outliers. white: (n,) variance of
    such a mean by the noise within it. first, last: (n,) samples of the run's recording, half open.
    """

    run: NDArray[np.int64]
    stamps: Stamps
    values: Array
    white: Array
    first: NDArray[np.int64]
    last: NDArray[np.int64]

    def __len__(self) -> int:
        """Return n."""
        return len(self.stamps)


def make_blocks(
    runs: Sequence[Run],
    channel: str,
    seconds: float,
    settling: float = SETTLING,
    samples: Sequence[Sliced] | None = None,
) -> Blocks:
    """Return the means of a channel over blocks of ``seconds`` in all runs.

    After a pause without power ``settling`` s are left out: the sensor may have been switched on in a ramp.
    samples: (n,) of each run in place of those of its recording.
    """
    columns = samples or [Column(run.recording.values, CHANNELS.index(channel)) for run in runs]
    parts = [
        _blocks_of(run, number, own, seconds, settling)
        for number, (run, own) in enumerate(zip(runs, columns, strict=True))
    ]
    return Blocks(*(np.concatenate([getattr(p, name) for p in parts]) for name in Blocks.__dataclass_fields__))


def _blocks_of(run: Run, number: int, values: Sliced, seconds: float, settling: float) -> Blocks:
    stamps = run.recording.stamps
    firsts, begins = _edges(stamps, run.recording.start, seconds)
    lasts = np.append(firsts[1:], len(stamps))
    typical = np.median(lasts - firsts)
    since_on = since_power_on(run, begins)
    means = np.concatenate([_means_between(stamps, values, *edges) for edges in _at_once(firsts, lasts)])
    good = (
        (lasts - firsts >= 0.5 * typical)
        & (since_on >= np.where(power_on_before(run, begins) > run.power_on[0], settling, SETTLING))
        & np.isfinite(means).all(axis=1)
    )
    middle = begins + means[:, 0].astype(np.int64)
    return Blocks(
        np.full(int(good.sum()), number), middle[good], means[good, 1], means[good, 2], firsts[good], lasts[good]
    )


def _edges(stamps: Sliced, start: int, seconds: float) -> tuple[NDArray[np.int64], Stamps]:
    """Return the first sample (n,) of each block of ``seconds`` from a start (ns), and its stamp."""
    firsts, begins = [], []
    before: NDArray[np.int64] | None = None
    for part in in_parts(len(stamps), MOST_AT_ONCE):
        own = stamps[part]
        index = np.floor(seconds_between(own, start) / seconds).astype(np.int64)
        edges = np.flatnonzero(np.diff(index, prepend=index[:1] - 1 if before is None else before))
        firsts.append(part.start + edges)
        begins.append(own[edges])
        before = index[-1:]
    return np.concatenate(firsts), np.concatenate(begins)


def _at_once(
    firsts: NDArray[np.int64], lasts: NDArray[np.int64]
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Yield the edges of blocks in groups that hold no more than MOST_AT_ONCE samples, or one block."""
    row = 0
    while row < len(firsts):
        stop = max(row + 1, int(np.searchsorted(lasts, firsts[row] + MOST_AT_ONCE, side="right")))
        yield firsts[row:stop], lasts[row:stop]
        row = stop


def _means_between(stamps: Sliced, values: Sliced, firsts: NDArray[np.int64], lasts: NDArray[np.int64]) -> Array:
    """Return ``_mean`` of blocks of samples (n, 3), which are read for it."""
    part = slice(int(firsts[0]), int(lasts[-1]))
    return _means(stamps[part], values[part], firsts - part.start, lasts - part.start)


def _means(stamps: Stamps, values: Array, firsts: NDArray[np.int64], lasts: NDArray[np.int64]) -> Array:
    """Return ``_mean`` of each block of samples, (n, 3): of those with nothing to leave out many at once."""
    means, left = np.empty((len(firsts), 3)), np.ones(len(firsts), dtype=bool)
    sizes = lasts - firsts
    whole = np.logical_and.reduceat(np.isfinite(values), firsts) & (sizes >= 3)
    for size in np.unique(sizes[whole]):
        same = np.flatnonzero(whole & (sizes == size))
        for part in np.array_split(same, -(-len(same) * int(size) // MOST_AT_ONCE)):
            samples = firsts[part, None] + np.arange(size)
            own, at = values[samples], stamps[samples]
            deviation = np.abs(own - np.median(own, axis=1)[:, None])
            spread = 1.4826 * np.median(deviation, axis=1)
            plain = (deviation <= OUTLIER * spread[:, None]).all(axis=1)
            own, at, rows = own[plain], at[plain], part[plain]
            means[rows, 0] = (at - at[:, :1]).astype(np.float64).mean(axis=1)
            means[rows, 1] = own.mean(axis=1)
            means[rows, 2] = 0.5 * np.mean(np.diff(own, axis=1) ** 2, axis=1) / size
            left[rows] = False
    for row in np.flatnonzero(left):
        means[row] = _mean(stamps[firsts[row] : lasts[row]], values[firsts[row] : lasts[row]])
    return means


def _mean(stamps: Stamps, values: Array) -> tuple[float, float, float]:
    """Return mean time from the first stamp (ns), mean and its variance, outliers from the median left out."""
    time = (stamps - stamps[0]).astype(np.float64)
    finite = np.isfinite(values)
    if finite.sum() < 3:
        return (float(time.mean()), float(values.mean()) if len(values) else np.nan, np.nan)
    middle = np.median(values[finite])
    deviation = np.abs(values - middle)
    spread = 1.4826 * np.median(deviation[finite])
    good = finite & (deviation <= OUTLIER * spread) if spread > 0.0 else finite
    kept = values[good]
    half = np.diff(kept)
    variance = 0.5 * np.mean(half**2) / len(kept) if len(kept) > 1 else np.nan
    return float(time[good].mean()), float(kept.mean()), float(variance)
