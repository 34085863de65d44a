"""What the genetic search reported on its way: how its error fell, and how long it took."""

from time import perf_counter

import numpy as np
from numpy.typing import NDArray


class SearchRecord:
    """Hears the progress of training; it changes nothing in it."""

    def __init__(self) -> None:
        """Start without a search."""
        self._heard: dict[str, list[tuple[float, float]]] = {}

    def add(self, channel: str, _generation: int, best: float) -> None:
        """Take the best error on left-out folds after a generation."""
        self._heard.setdefault(channel, []).append((perf_counter(), best))

    def errors(self, channel: str) -> NDArray[np.float64]:
        """Return the best error so far after each generation of all searches of a channel (k,), in its unit."""
        return np.minimum.accumulate(np.array([best for _, best in self._heard.get(channel, ())], dtype=np.float64))

    def seconds(self, channel: str) -> float | None:
        """Return how long the searches of a channel took, None where there was none.

        The first generation, whose beginning was not heard, counts as long as the others.
        """
        times = [at for at, _ in self._heard.get(channel, ())]
        return (times[-1] - times[0]) * len(times) / (len(times) - 1) if len(times) > 1 else None
