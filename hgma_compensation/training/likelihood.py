"""Marginal likelihood of ridge fits: how probable the target is, the weights integrated out (MacKay 1992)."""

import numpy as np

from hgma_compensation.drift.inputs import Array


def marginal_error(columns: Array, target: Array, penalty: Array, penalised: int) -> Array:
    """Return a measure of how unlikely the target is under a population of ridge fits, shape (p,).

    columns: (p, n, k). target: (n,). penalty: (p, k) > 0, per sample, as ``solve_ridge`` has it: weights are normal
    about 0 with the variance σ²/(n penalty), the noise is white with the variance σ², which is at its likeliest. Only
    the first ``penalised`` columns have such weights; of the others, as good as free, nothing is known before.

    -2 log p(y) = (n - free) log(Q/n) + log det(ΦᵀΦ + nΛ) - Σ log(n λ) + constant, Q = |y - Φw|² + n Σ λ w². Returned is
    exp(-log p(y) / (n - free)), an RMS of what is left with its price in weights: as a fitness it orders candidates as
    the likelihood would, and it has the unit of the target. One fit hears nothing of the others.
    """
    samples, count = columns.shape[1:]
    free = count - penalised
    own = samples * penalty
    transposed = columns.transpose(0, 2, 1)
    gram = transposed @ columns + own[:, :, None] * np.eye(count)
    weights = np.linalg.solve(gram, transposed @ target[:, None])[..., 0]
    left = target - (columns @ weights[..., None])[..., 0]
    energy = np.einsum("pn,pn->p", left, left) + np.einsum("pk,pk,pk->p", own, weights, weights)
    # A target that is fitted without rest has no likeliest noise: every network of it is as good.
    energy = np.maximum(energy, np.finfo(np.float64).tiny)
    volume = np.linalg.slogdet(gram)[1] - np.log(own[:, :penalised]).sum(axis=1)
    return np.asarray(np.sqrt(energy / samples) * np.exp(0.5 * volume / (samples - free)))
