"""The value that a still sensor should show: what is left of the raw output is drift."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.channels import AXES, GROUPS, group_of
from hgma_compensation.errors import RefusedError


@dataclass(frozen=True)
class Reference:
    """numbers: as the user gave them; none means the recordings' own mean, so only drift is removed."""

    numbers: tuple[float, ...] = ()

    @classmethod
    def parse(cls, text: str) -> "Reference":
        """Return the reference written as ``mean``, ``X`` or ``X,Y,Z``; raises RefusedError."""
        if text.strip() == "mean":
            return cls()
        try:
            numbers = tuple(float(part) for part in text.split(","))
        except ValueError:
            numbers = (float("nan"),)
        if not all(np.isfinite(numbers)):
            raise RefusedError(f"--reference {text}: write mean, one number, or one number for each channel (X,Y,Z)")
        return cls(numbers)

    def __str__(self) -> str:
        """Return the text that parse reads."""
        return ",".join(repr(number) for number in self.numbers) or "mean"

    def of(self, channels: Sequence[str], values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the reference of each channel (c,), given its samples or means (n, c).

        One number serves all channels; three are for the axes of the acceleration; else there must be
        one for each channel. Raises RefusedError where the numbers do not fit.
        """
        # Column by column: a sum over rows would round differently for another set of channels.
        return self.beside(channels, lambda: np.array([np.mean(column[np.isfinite(column)]) for column in values.T]))

    def beside(self, channels: Sequence[str], means: Callable[[], NDArray[np.float64]]) -> NDArray[np.float64]:
        """Return the reference of each channel (c,) as ``of`` does, given what returns the samples' means (c,)."""
        if not self.numbers:
            return means()
        if len(self.numbers) == 1:
            return np.full(len(channels), self.numbers[0])
        if len(self.numbers) == len(AXES) and all(group_of(c) == GROUPS[0] for c in channels):
            return np.array([self.numbers[AXES.index(c[-1])] for c in channels])
        if len(self.numbers) == len(channels):
            return np.array(self.numbers)
        raise RefusedError(
            f"--reference has {len(self.numbers)} numbers for the channels {', '.join(channels)}: "
            "give one number, or one for each of them"
        )
