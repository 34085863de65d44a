"""First-order low-pass x ← k x + (1 - k) z, step by step and in bulk, the same to the last bit.

With k in floating point, 1 - k is exact: a level that is reached stays, whatever k.
"""

import threading
from collections.abc import Callable, Iterable
from functools import cache
from itertools import repeat
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEWEST = 512
"""Samples from which on scipy.signal is worth its call, and at the first time its import of a third of a second."""

LONGEST = 16384
"""Samples that the recursion goes through in one call."""


def low_pass_step(level: float, keep: float, value: float) -> float:
    """Return the level after one value, of which 1 - keep is taken in."""
    return keep * level + (1.0 - keep) * value


def low_pass(level: float, keep: float | Array, values: Array) -> Array:
    """Return the level before the first and after each of n finite values, (n + 1,).

    keep: one for all, which is the fastest case, or (n,). Every bit is that of low_pass_step.
    """
    levels = np.empty(len(values) + 1)
    levels[0] = level
    compiled = LFILTER.get() if len(values) >= FEWEST else NOTHING
    if isinstance(keep, float):
        if compiled.lfilter is not None:
            levels[1:] = compiled.lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * level])[0]
        else:
            levels[1:] = _one_by_one(level, repeat(keep, len(values)), ((1.0 - keep) * values).tolist())
        return levels
    np.multiply(1.0 - keep, values, out=levels[1:])
    if compiled.recursion is not None:
        for first in range(0, len(values), LONGEST):
            part = slice(first, min(first + LONGEST, len(values)))
            levels[part.start : part.stop + 1] = compiled.recursion(keep[part], levels[part.start : part.stop + 1])
    else:
        levels[1:] = _one_by_one(level, keep.tolist(), levels[1:].tolist())
    return levels


def _one_by_one(level: float, keeps: Iterable[float], terms: Iterable[float]) -> list[float]:
    levels = []
    for keep, term in zip(keeps, terms, strict=True):
        level = keep * level + term
        levels.append(level)
    return levels


class Recursion:
    """x[k + 1] = keep[k] x[k] + term[k] by a routine of LAPACK, dgttrs.

    It solves a tridiagonal system whose factors are given. Of these only the multipliers below the diagonal are not
    trivial, so that forward substitution is the recursion, in its order, and back substitution changes nothing.
    """

    def __init__(self) -> None:
        """Lay out the trivial factors once."""
        from scipy.linalg.lapack import dgttrs

        self._solve = dgttrs
        self._ones, self._zeros = np.ones(LONGEST + 1), np.zeros(LONGEST)
        self._pivots = np.arange(1, LONGEST + 2, dtype=np.int32)

    def __call__(self, keep: Array, terms: Array) -> Array:
        """Return all x (n + 1,), 1 <= n <= LONGEST, for keep (n,) and terms (n + 1,): x[0], then what is added."""
        n = len(keep)
        if n > 1:  # scipy's wrapper takes no smaller system
            below, beside, above = -keep, self._zeros[:n], self._zeros[: n - 1]
            solution, _ = self._solve(below, self._ones[: n + 1], beside, above, self._pivots[: n + 1], terms)
            # Back substitution takes the sign of a negative zero away, and an overflow back to the beginning as NaN.
            if solution[0] == terms[0] and (solution != 0.0).all():
                return np.asarray(solution)
        return np.array([terms[0], *_one_by_one(float(terms[0]), keep.tolist(), terms[1:].tolist())])


class Compiled(NamedTuple):
    """scipy's lfilter and the recursion, each None where it is not to be had."""

    lfilter: Callable[..., Any] | None
    recursion: Callable[[Array, Array], Array] | None


NOTHING = Compiled(None, None)


@cache
def load_compiled() -> Compiled:
    """Return those of scipy's routines that compute what low_pass_step does.

    The direct form II transposed of lfilter is y = s + (1 - k) z, s = k y, in this order, and the recursion's is the
    same. A compiler that rounds a product and a sum only once (FMA, the default on some processors) gives other bits:
    such a machine goes without. Loading takes a third of a second once.
    """
    from scipy.signal import lfilter

    keep, values = 0.9, np.sin(np.arange(200.0))
    terms = (1.0 - keep) * values
    expected = np.array([0.3, *_one_by_one(0.3, repeat(keep, len(values)), terms.tolist())]).tobytes()
    recursion = Recursion()
    filtered = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * 0.3])[0]
    solved = recursion(np.full(len(values), keep), np.append(0.3, terms))
    return Compiled(
        lfilter if np.append(0.3, filtered).tobytes() == expected else None,
        recursion if solved.tobytes() == expected else None,
    )


class _Loader:
    """Gives the routines where they are wanted; wait: whether for their loading, as a process that serves must not."""

    def __init__(self) -> None:
        self.wait = True
        self._loading: threading.Thread | None = None

    def get(self) -> Compiled:
        """Return them, or NOTHING while they are being loaded."""
        if not self.wait and self._loading is None:
            self._loading = threading.Thread(target=load_compiled, name="loading")
            self._loading.start()
        if self._loading is not None and self._loading.is_alive():
            return NOTHING
        return load_compiled()


LFILTER = _Loader()
