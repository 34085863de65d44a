"""What the pipeline makes of samples."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Slow(Protocol):
    """What the slow inputs say of n samples and c channels; arrays may be computed when they are asked for."""

    @property
    def ordinary(self) -> bool:
        """Whether every status is OK."""
        ...

    @property
    def drift(self) -> Array:
        """(n, c) of drift model and slow effects."""
        ...

    def take(self, rows: NDArray[np.int64]) -> "Slow":
        """Return the same of some samples (k,)."""
        ...

    @property
    def features(self) -> Array:
        """(n, 3) before clamping."""
        ...

    @property
    def inside_range(self) -> NDArray[np.bool_]:
        """(n,) whether the features lie in the calibrated range."""
        ...

    @property
    def status(self) -> NDArray[np.uint8]:
        """(n,) TemperatureStatus."""
        ...

    @property
    def uncertainty(self) -> Array:
        """(n, c) standard deviation of the drift."""
        ...


class Compensated:
    """Result for n samples and c channels, in the order of the calibration.

    values: compensated, (n, c). unfiltered: raw less drift, (n, c).
    """

    FIELDS = ("values", "drift", "innovation", "features", "inside_range", "status", "uncertainty")
    """All that splitting the samples over calls must not change."""

    def __init__(
        self, values: Array, unfiltered: Array, slow: Slow, drift: Array | None = None, innovation: Array | None = None
    ) -> None:
        """Take arrays, and what the slow inputs say.

        drift: None where it is that of the slow inputs. innovation: None where no channel has a Kalman stage.
        """
        self.values, self.unfiltered, self._slow = values, unfiltered, slow
        self._drift, self._innovation = drift, innovation

    @property
    def drift(self) -> Array:
        """What was subtracted, (n, c)."""
        return self._slow.drift if self._drift is None else self._drift

    @property
    def innovation(self) -> Array:
        """Innovation of the Kalman stage, (n, c), 0 where it is off."""
        return np.zeros(self.values.shape) if self._innovation is None else self._innovation

    @property
    def ordinary(self) -> bool:
        """Whether the temperature of all samples is what the calibration knows, so that every status is OK."""
        return self._slow.ordinary

    @property
    def features(self) -> Array:
        """Features (n, 3) before clamping; the middle of the calibrated range where the temperature is missing."""
        return self._slow.features

    @property
    def inside_range(self) -> NDArray[np.bool_]:
        """Whether the features lie in the calibrated range, (n,)."""
        return self._slow.inside_range

    @property
    def status(self) -> NDArray[np.uint8]:
        """TemperatureStatus (n,)."""
        return self._slow.status

    @property
    def uncertainty(self) -> Array:
        """Standard deviation of the drift, (n, c)."""
        return self._slow.uncertainty

    def added_variance(self, row: int) -> Array | None:
        """Return by what (c,) a sample's variances grow; None where the temperature is what the calibration knows."""
        if self.ordinary or not self.status[row]:
            return None
        return np.asarray(self.uncertainty[row] ** 2)

    def added_variances(self) -> Array | None:
        """Return ``added_variance`` for all samples (n, c), NaN for nothing in a row; None for nothing at all."""
        if self.ordinary:
            return None
        return np.where((self.status > 0)[:, None], self.uncertainty**2, np.nan)

    def take(self, rows: NDArray[np.int64]) -> "Compensated":
        """Return the results of some samples (k,)."""
        drift, innovation = (None if array is None else array[rows] for array in (self._drift, self._innovation))
        return Compensated(self.values[rows], self.unfiltered[rows], self._slow.take(rows), drift, innovation)


class _Joined:
    """What the slow inputs say of consecutive samples."""

    def __init__(self, parts: Sequence[Compensated]) -> None:
        self._parts = parts
        self.ordinary = all(part.ordinary for part in parts)

    def take(self, rows: NDArray[np.int64]) -> Slow:
        return _Given(*(self._join(name)[rows] for name in _Given.__dataclass_fields__))

    def _join(self, name: str) -> NDArray[Any]:
        return np.concatenate([getattr(part, name) for part in self._parts])

    @cached_property
    def drift(self) -> Array:
        return self._join("drift")

    @cached_property
    def features(self) -> Array:
        return self._join("features")

    @cached_property
    def inside_range(self) -> NDArray[np.bool_]:
        return self._join("inside_range")

    @cached_property
    def status(self) -> NDArray[np.uint8]:
        return self._join("status")

    @cached_property
    def uncertainty(self) -> Array:
        return self._join("uncertainty")


def joined(parts: Sequence[Compensated]) -> Compensated:
    """Return the results of consecutive samples as one."""
    values, unfiltered, innovation = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("values", "unfiltered", "innovation")
    )
    return Compensated(values, unfiltered, _Joined(parts), innovation=innovation)


@dataclass(frozen=True)
class _Given:
    """What the slow inputs say, as arrays."""

    drift: Array
    features: Array
    inside_range: NDArray[np.bool_]
    status: NDArray[np.uint8]
    uncertainty: Array

    @property
    def ordinary(self) -> bool:
        return not self.status.any()

    def take(self, rows: NDArray[np.int64]) -> Slow:
        return _Given(*(getattr(self, name)[rows] for name in _Given.__dataclass_fields__))


def zeros(samples: int, channels: int) -> Compensated:
    """Return a result in which everything is 0, for no sample or as a form to be filled in."""
    none, of_features = np.zeros((samples, channels)), np.zeros((samples, 3))
    slow = _Given(none, of_features, np.zeros(samples, dtype=np.bool_), np.zeros(samples, dtype=np.uint8), none)
    return Compensated(none, none, slow)
