"""Which effect, with which parameters, carries most of what is left: scoring after whitening.

Model: y = X w + Σ Φₑ(θₑ) kₑ + noise, X the baseline. After whitening, baseline and accepted effects are projected
out (Frisch and Waugh 1933), so the gain of an effect is |Qᵀ r|², Q an orthonormal basis of what is left of its
columns; on noise it is χ² with as many degrees of freedom as columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.baseline import independent
from hgma_compensation.diagnosis.whitener import Whitener
from hgma_compensation.effects.effect import Effect

Array = NDArray[np.float64]

SEEN = 1e-4
"""Share of a column's whitened energy that the baseline must leave: below it is the baseline's own rounding."""


@dataclass(frozen=True)
class Projection:
    """The whitened problem without what is explained already. residual: (n,). known: (n, r) orthonormal."""

    whitener: Whitener
    known: Array
    residual: Array

    @classmethod
    def of(cls, whitener: Whitener, known: Array, target: Array) -> "Projection":
        """Return the projection of a target (n,) off the columns known (n, k)."""
        basis = independent(whitener(known))
        white = whitener(target)
        return cls(whitener, basis, white - basis @ (basis.T @ white))

    def added(self, columns: Array) -> "Projection":
        """Return the projection with columns (n, k) known as well."""
        new = self.directions(columns)
        return Projection(self.whitener, np.hstack([self.known, new]), self.residual - new @ (new.T @ self.residual))

    def directions(self, columns: Array) -> Array:
        """Return orthonormal directions (n, r) of columns (n, k), whitened, off what is known."""
        white = self.whitener(columns)
        # Hundreds of columns of slow change are megabytes, as is every copy of them: no more of them than must be.
        del columns
        norms = np.linalg.norm(white, axis=0)
        for _ in range(2):
            white -= self._along(white)
        seen = np.linalg.norm(white, axis=0) > np.sqrt(SEEN) * np.maximum(norms, 1e-300)
        left = white[:, seen]
        del white
        return independent(left, 1e-4, overwrite=True)

    def _along(self, columns: Array) -> Array:
        """Return the part of columns (n,) or (n, k), whitened, that is known."""
        return np.asarray(self.known @ (self.known.T @ columns))


@dataclass(frozen=True)
class Scored:
    """An effect with its gain, its columns' rank, and its BIC (less is better, 0 is no effect)."""

    effect: Effect
    gain: float
    rank: int
    bic: float
    columns: Array
    directions: Array

    @property
    def name(self) -> str:
        """Return the kind's name."""
        return self.effect.name

    def figures(self) -> "Scored":
        """Return the same without columns and directions, which take the memory."""
        return replace(self, columns=np.empty((0, 0)), directions=np.empty((0, 0)))


def searched_count(effect: Effect) -> int:
    """Return the number of nonlinear parameters that are looked for."""
    return sum(span.searched for span in effect.spans.values())


def score(projection: Projection, effects: Sequence[Effect], columns: Sequence[Array]) -> list[Scored]:
    """Return the effects, with their columns (n, k) each, scored; in their order."""
    n = len(projection.residual)
    scored = []
    for effect, own in zip(effects, columns, strict=True):
        q = projection.directions(own)
        gain, rank = float(np.sum((q.T @ projection.residual) ** 2)), q.shape[1]
        bic = -gain + (rank + searched_count(effect)) * np.log(n)
        scored.append(Scored(effect, gain, rank, float(bic), own, q))
    return scored
