"""First-order low-pass x ← k x + (1 - k) z, step by step and in bulk, the same to the last bit.

With k in floating point, 1 - k is exact: a level that is reached stays, whatever k.
"""

import threading
from collections.abc import Callable, Iterable
from functools import cache
from itertools import repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEWEST = 512
"""Samples from which on scipy.signal is worth its call, and at the first time its import of a third of a second."""


def low_pass_step(level: float, keep: float, value: float) -> float:
    """Return the level after one value, of which 1 - keep is taken in."""
    return keep * level + (1.0 - keep) * value


def low_pass(level: float, keep: float | Array, values: Array) -> Array:
    """Return the level before the first and after each of n finite values, (n + 1,).

    keep: one for all, which is the fast case, or (n,). Every bit is that of low_pass_step.
    """
    levels = np.empty(len(values) + 1)
    levels[0] = level
    if isinstance(keep, float) and len(values) >= FEWEST and (lfilter := LFILTER.get()) is not None:
        levels[1:] = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * level])[0]
    else:
        keeps = repeat(keep, len(values)) if isinstance(keep, float) else keep.tolist()
        levels[1:] = _one_by_one(level, keeps, ((1.0 - keep) * values).tolist())
    return levels


def _one_by_one(level: float, keeps: Iterable[float], terms: Iterable[float]) -> list[float]:
    levels = []
    for keep, term in zip(keeps, terms, strict=True):
        level = keep * level + term
        levels.append(level)
    return levels


@cache
def load_lfilter() -> Callable[..., Any] | None:
    """Return scipy's lfilter if it computes what low_pass_step does, None where it does not.

    Its direct form II transposed is y = s + (1 - k) z, s = k y, in this order. A compiler that rounds a product and a
    sum only once (FMA, the default on some processors) gives other bits: such a machine goes without it. Loading takes
    a third of a second once.
    """
    from scipy.signal import lfilter

    keep, values = 0.9, np.sin(np.arange(200.0))
    expected = _one_by_one(0.3, repeat(keep, len(values)), ((1.0 - keep) * values).tolist())
    found = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * 0.3])[0]
    same = bool(np.asarray(found).tobytes() == np.array(expected).tobytes())
    return lfilter if same else None


class _Lfilter:
    """Gives lfilter where it is wanted; wait: whether for its loading, as a process with a stream to serve must not."""

    def __init__(self) -> None:
        self.wait = True
        self._loading: threading.Thread | None = None

    def get(self) -> Callable[..., Any] | None:
        """Return it, or None: where there is none that gives the bits of the steps, and while it is being loaded."""
        if not self.wait and self._loading is None:
            self._loading = threading.Thread(target=load_lfilter, name="loading")
            self._loading.start()
        if self._loading is not None and self._loading.is_alive():
            return None
        return load_lfilter()


LFILTER = _Lfilter()
