"""Whether what is left is noise: slow energy of the whitened residual."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from hgma_compensation.diagnosis.noise_model import slow_cosines
from hgma_compensation.diagnosis.problem import State
from hgma_compensation.diagnosis.search import Projection

Array = NDArray[np.float64]

SLOWEST = 300.0
"""s: what changes faster is judged by the noise model itself; structure in temperature is slower."""


@dataclass(frozen=True)
class Leftover:
    """Slow part of a residual. energy: of it, whitened; 1 for each of ``size`` on noise."""

    energy: float
    size: int

    @property
    def dispersion(self) -> float:
        """Energy for each degree of freedom, not below 1."""
        return max(1.0, self.energy / max(self.size, 1))

    @property
    def p_value(self) -> float:
        """Probability of that much on noise."""
        return float(chi2.sf(self.energy, max(self.size, 1)))


def slow_directions(state: State) -> Array:
    """Return whitened orthonormal directions (n, m) of slow change that the state has not explained."""
    blocks = state.problem.scene.blocks
    return state.projection.directions(slow_cosines(blocks.run, blocks.stamps, SLOWEST))


def leftover(projection: Projection, slow: Array) -> Leftover:
    """Return the slow part of a projection's residual; slow (n, m) as ``slow_directions`` gives it."""
    parts = slow.T @ projection.residual
    return Leftover(float(parts @ parts), slow.shape[1])
