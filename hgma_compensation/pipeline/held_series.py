"""A slow scalar input of which the newest sample counts: the supply voltage."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.stamps import Stamps, to_nanoseconds
from hgma_compensation.temperature.track import Sample, judge
from hgma_compensation.temperature.updates import Updates


class HeldSeries:
    """Samples that hold until the next one; a sample counts for stamps at least the latency after its own."""

    def __init__(self, latency: float, *, keep: float | None = None) -> None:
        """Start empty; latency: s. keep: s of history to hold on to, None for all of it."""
        self._latency = to_nanoseconds(latency)
        self._samples = Updates(keep=None if keep is None else to_nanoseconds(keep))

    def __len__(self) -> int:
        """Return the number of samples that are held."""
        return len(self._samples)

    @property
    def last(self) -> int | None:
        """Stamp of the newest sample, ns."""
        return self._samples.last

    def reset(self) -> None:
        """Forget all samples."""
        self._samples.reset()

    def add(self, stamp: int, value: float) -> Sample:
        """Take a sample (stamp in ns) and say what became of it, as for the thermistor."""
        outcome = judge(stamp, value, self._samples.last)
        if outcome is Sample.RESTARTED:
            self.reset()
        elif outcome is not Sample.USED:
            return outcome
        self._samples.append(stamp, value, 0.0)
        return outcome

    def read(self, stamps: Stamps) -> NDArray[np.float64]:
        """Return the value (n,) at stamps (n,) in ns, NaN before the first sample counts."""
        # A pause says nothing here, so that after one too a sample counts only once it is as old as the latency.
        counted = stamps - self._latency
        value, _, _ = self._samples.read(counted, 0, 0.0)
        first = self._samples.first
        return value if first is None else np.where(counted < first, np.nan, value)

    def snapshot(self, reach: float) -> dict[str, Any]:
        """Return, as plain JSON, the samples that readings within ``reach`` s of the newest depend on."""
        return self._samples.snapshot(to_nanoseconds(reach))

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot; raises ValueError where it does not fit."""
        self._samples.restore(snapshot)
