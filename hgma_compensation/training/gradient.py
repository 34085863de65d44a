"""The plain RBF network, trained by gradient descent on the output error, Eq. (6) of Zhu et al. 2019.

Kept as the baseline that the genetic search is compared with. Centres by k-means, one width for all
(Haykin 2009, section 5.6: σ = d_max / √(2m)), weights by descent with momentum on the squared error.
No linear terms: the paper's network has none.
"""

import numpy as np
from scipy.cluster.vq import kmeans2

from hgma_compensation.drift.inputs import Array, InputScaling
from hgma_compensation.drift.radial_basis import RadialBasisDrift, basis

CENTRES = 15
EPOCHS = 2000
MOMENTUM = 0.9


def train_by_gradient(features: Array, target: Array, *, seed: int, centres: int = CENTRES) -> RadialBasisDrift:
    """Return the network for features (n, d) and drift (n,); the same seed gives the same network."""
    scaling = InputScaling.of(features)
    inputs = scaling.apply(features)
    middle, _ = kmeans2(inputs, centres, minit="++", seed=np.random.default_rng(seed))
    distances = np.linalg.norm(middle[:, None] - middle[None], axis=2)
    widths = np.full(middle.shape, max(float(distances.max()), 1e-6) / np.sqrt(2.0 * centres))
    columns = basis(inputs, middle, widths)[:, : centres + 1]
    weights = _descend(columns, target)
    return RadialBasisDrift(
        scaling, middle, widths, weights[:centres], float(weights[centres]), np.zeros(inputs.shape[1])
    )


def _descend(columns: Array, target: Array) -> Array:
    """Return weights after EPOCHS steps w += η Φᵀe/n + α Δw, η at the edge of what converges."""
    rate = 1.0 / float(np.linalg.eigvalsh(columns.T @ columns / len(target))[-1])
    weights = np.zeros(columns.shape[1])
    step = np.zeros_like(weights)
    for _ in range(EPOCHS):
        error = target - columns @ weights
        step = rate * (columns.T @ error) / len(target) + MOMENTUM * step
        weights = weights + step
    return weights
