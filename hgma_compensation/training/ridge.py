"""Ridge least squares: one fit done well, and many fits done fast."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.drift.inputs import Array


def solve_ridge(columns: Array, target: Array, penalty: Array) -> Array:
    """Return the w that minimises |columns w - target|² + n Σ penalty_k w_k².

    columns: (n, k). target: (n,). penalty: (k,) >= 0, per sample. Solved by an orthogonal
    factorisation of the augmented system, never through the normal equations.
    """
    rows = np.diag(np.sqrt(penalty * len(target)))
    augmented = np.vstack([columns, rows])
    solution, *_ = np.linalg.lstsq(augmented, np.concatenate([target, np.zeros(len(penalty))]), rcond=None)
    return np.asarray(solution)


def cross_validated_rms(columns: Array, target: Array, penalty: Array, folds: NDArray[np.int64]) -> Array:
    """Return the RMS error on left-out folds of a population of ridge fits, shape (p,).

    columns: (p, n, k). target: (n,). penalty: (p, k). folds: (n,), 0 to the number of folds - 1.

    Each fold's Gram matrix is formed once and subtracted from their sum, so a fit without one fold
    costs a solve of k equations. The normal equations are good enough to rank candidates: the penalty
    bounds their condition number, and the winner is fitted again by ``solve_ridge``.
    """
    parts = [np.flatnonzero(folds == fold) for fold in range(int(folds.max()) + 1)]
    blocks = [columns[:, part] for part in parts]
    grams = [block.transpose(0, 2, 1) @ block for block in blocks]
    products = [block.transpose(0, 2, 1) @ target[part] for block, part in zip(blocks, parts, strict=True)]
    gram, product = sum(grams), sum(products)
    squares = np.zeros(len(columns))
    for block, part, own_gram, own_product in zip(blocks, parts, grams, products, strict=True):
        ridge = penalty[:, :, None] * np.eye(columns.shape[2]) * (len(target) - len(part))
        weights = np.linalg.solve(gram - own_gram + ridge, (product - own_product)[..., None])
        error = target[part] - (block @ weights)[..., 0]
        squares += np.einsum("pn,pn->p", error, error)
    return np.asarray(np.sqrt(squares / len(target)))
