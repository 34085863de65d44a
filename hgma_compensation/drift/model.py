"""What every drift model can do, and the box of features in which it may be asked."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.drift.inputs import Array


class DriftModel(Protocol):
    """Drift of one channel as a function of the temperature features."""

    def evaluate(self, features: Array) -> Array:
        """Return the drift (n,) in the channel's unit at features (n, 3) inside the calibrated range."""
        ...


@dataclass(frozen=True)
class CalibratedRange:
    """The box of features that training has seen; lower and upper have shape (3,).

    Outside of it every fitted model is wrong without bound, so features are clamped to it.
    """

    lower: Array
    upper: Array

    MARGIN = 0.02
    """Share of each side added to it: the noise of Ṫ at the edge is no extrapolation."""

    @classmethod
    def of(cls, features: Array) -> "CalibratedRange":
        """Return the range of training features (n, 3), with the margin."""
        lower, upper = features.min(axis=0), features.max(axis=0)
        margin = cls.MARGIN * (upper - lower)
        return cls(lower - margin, upper + margin)

    @property
    def middle(self) -> Array:
        """Centre of the box, shape (3,)."""
        return 0.5 * (self.lower + self.upper)

    def corners(self) -> Array:
        """Return corners, and middles of edges, faces and the box: (27, 3)."""
        points = np.meshgrid(*zip(self.lower, self.middle, self.upper, strict=True))
        return np.stack(points, axis=-1).reshape(-1, 3)

    def clamp(self, features: Array) -> Array:
        """Return features (n, 3) moved to the nearest point of the box."""
        return np.clip(features, self.lower, self.upper)

    def contains(self, features: Array) -> NDArray[np.bool_]:
        """Return for each row whether it lies in the box; a row with NaN does not."""
        return np.asarray(np.all((features >= self.lower) & (features <= self.upper), axis=1))
