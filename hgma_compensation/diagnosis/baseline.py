"""What a drift model of the present temperature could carry, whatever its weights: never an effect."""

from math import inf

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import svd

from hgma_compensation.drift.inputs import InputScaling
from hgma_compensation.drift.radial_basis import RadialBasisDrift, basis

Array = NDArray[np.float64]

STATIC_CENTRES = 16
OVERLAP = 1.3
"""Width of a Gaussian over the distance to the next one."""

UNBOUNDED = 1e6
"""Width, in standard deviations, of an input that a Gaussian shall not depend on."""


def static_centres(scaling: InputScaling, lower: float, upper: float, count: int) -> tuple[Array, Array]:
    """Return centres and widths (count, 3), scaled, of Gaussians in the temperature alone (°C from lower to upper)."""
    if count == 0:
        return np.empty((0, 3)), np.empty((0, 3))
    at = (np.linspace(lower, upper, count) - scaling.offset[0]) / scaling.scale[0]
    spacing = (upper - lower) / max(count - 1, 1) / scaling.scale[0]
    centres, widths = np.zeros((count, 3)), np.full((count, 3), UNBOUNDED)
    centres[:, 0], widths[:, 0] = at, OVERLAP * spacing
    return centres, widths


def smooth_network(features: Array, resolved: float) -> RadialBasisDrift:
    """Return a network of Gaussians in the temperature, with the linear terms of all features, weights still 0.

    features: (n, 3) that it must cover. resolved: °C, distance below which two temperatures are the same; Gaussians
    are no closer, and there are none where the temperature stood still. A hidden layer that bends with Ṫ too would fit
    more, and mislead between the rates of the recordings; what a sensor does with the rate beyond a linear term is an
    effect with a name.
    """
    lower, upper = float(features[:, 0].min()), float(features[:, 0].max())
    count = min(STATIC_CENTRES, int((upper - lower) / resolved))
    scaling = InputScaling.of(features)
    centres, widths = static_centres(scaling, lower, upper, count)
    return RadialBasisDrift(scaling, centres, widths, np.zeros(len(centres)), 0.0, np.zeros(3))


def regressors(drift: RadialBasisDrift, features: Array) -> Array:
    """Return the columns (n, k) that the weights of a network multiply, at features (n, 3)."""
    return basis(drift.scaling.apply(features), drift.centres, drift.widths)


def independent(columns: Array, tolerance: float = 1e-7, *, overwrite: bool = False) -> Array:
    """Return orthonormal columns (n, r) that span columns (n, k) up to the tolerance of the largest.

    overwrite: whether the columns may be lost, which takes less memory where they are in Fortran's order.
    """
    norms = np.linalg.norm(columns, axis=0)
    seen = norms > 0.0
    scaled = columns if overwrite and seen.all() else columns[:, seen]
    scaled /= norms[seen]
    if not scaled.shape[1]:
        return np.empty((len(columns), 0))
    # In place, which numpy's does not offer: of hundreds of columns every copy is megabytes.
    del columns
    u, s, _ = svd(scaled, full_matrices=False, overwrite_a=True, check_finite=False)
    good = s > tolerance * max(s[0], -inf)
    return np.asfortranarray(u if good.all() else u[:, good])
