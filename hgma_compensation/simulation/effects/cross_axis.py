"""An axis that feels another one."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.channels import AXES
from hgma_compensation.simulation.effect import Array, Effect, Surroundings


@dataclass(frozen=True)
class CrossAxis(Effect):
    """source: the other axis. gain: share of its true acceleration."""

    source: str
    gain: float

    def drift(self, around: Surroundings, random: np.random.Generator) -> Array:
        """Return k·u (n,), u the true acceleration along the source."""
        return np.asarray(self.gain * around.acceleration[:, AXES.index(self.source)])
