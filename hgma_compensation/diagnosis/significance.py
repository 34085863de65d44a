"""How often noise alone would have brought such a gain, over all that was tried."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln
from scipy.stats import chi2, gumbel_r

from hgma_compensation.diagnosis.search import Projection

Array = NDArray[np.float64]

SURROGATES = 200


@dataclass(frozen=True)
class NullMaxima:
    """Largest score of each surrogate recording: noise of the model, the thermistor's carried noise included.

    A score is −log₁₀ of the χ² probability of a gain with as many degrees of freedom as columns, so that effects of
    different size are on one scale.
    """

    maxima: Array

    def p_value(self, score: float) -> float:
        """Return the share of surrogates that reach a score; beyond them the tail of a Gumbel law fitted to them."""
        reached = int(np.sum(self.maxima >= score))
        if reached > 5:
            return (reached + 1) / (len(self.maxima) + 1)
        place, scale = gumbel_r.fit(self.maxima)
        return min(float(gumbel_r.sf(score, place, scale)), (reached + 1) / (len(self.maxima) + 1))


def null_maxima(
    projection: Projection, directions: Sequence[Array], random: np.random.Generator, count: int = SURROGATES
) -> NullMaxima:
    """Return the maxima over candidates; directions: (n, r) of each, orthonormal, whitened, off what is known."""
    noise = random.standard_normal((len(projection.residual), count))
    noise -= projection.known @ (projection.known.T @ noise)
    maxima = np.zeros(count)
    for q in directions:
        if q.shape[1]:
            maxima = np.maximum(maxima, score_of(np.sum((q.T @ noise) ** 2, axis=0), q.shape[1]))
    return NullMaxima(maxima)


def score_of(gain: Array | float, rank: int, dispersion: float = 1.0) -> Array:
    """Return −log₁₀ P(χ² with ``rank`` degrees of freedom > gain / dispersion)."""
    x, k = np.asarray(gain) / dispersion, max(rank, 1)
    logarithm = chi2.logsf(x, k)
    # Where the probability underflows: the first term of its asymptotic series (Abramowitz and Stegun, 26.4.12).
    far = -0.5 * x + (0.5 * k - 1.0) * np.log(np.maximum(0.5 * x, 1e-300)) - gammaln(0.5 * k)
    return np.asarray(np.where(np.isfinite(logarithm), logarithm, far) / -np.log(10.0))
