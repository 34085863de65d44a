"""Ridge least squares: one fit done well, and many fits done fast."""

from dataclasses import dataclass

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


@dataclass(frozen=True)
class LeftOutFolds:
    """Rows of a fit sorted fold by fold, so that the rows of a fold are a slice that no fit need copy.

    order: (n,) original rows, in their order within each fold. places: the slice of each fold.
    """

    order: NDArray[np.int64]
    places: tuple[slice, ...]

    @classmethod
    def of(cls, folds: NDArray[np.int64]) -> "LeftOutFolds":
        """Return the sorting of folds (n,), 0 to the number of folds - 1."""
        ends = np.cumsum(np.bincount(folds))
        places = tuple(slice(int(a), int(b)) for a, b in zip([0, *ends[:-1]], ends, strict=True))
        return cls(np.argsort(folds, kind="stable"), places)

    def rms(self, columns: Array, target: Array, penalty: Array) -> Array:
        """Return the RMS error on left-out folds of a population of ridge fits, shape (p,).

        columns: (p, n, k) and target: (n,), rows sorted. penalty: (p, k). One fit hears nothing of the others.

        Each fold's Gram matrix is formed once and subtracted from their sum, so a fit without one fold
        costs a solve of k equations. The normal equations are good enough to rank candidates: the penalty
        bounds their condition number, and the winner is fitted again by ``solve_ridge``.
        """
        blocks = [columns[:, place] for place in self.places]
        targets = [target[place] for place in self.places]
        grams = np.stack([block.transpose(0, 2, 1) @ block for block in blocks])
        products = np.stack([block.transpose(0, 2, 1) @ own for block, own in zip(blocks, targets, strict=True)])
        # Samples that each fit sees, (folds, 1, 1, 1): the penalty is one per sample.
        seen = np.array([len(target) - len(own) for own in targets], dtype=np.float64)[:, None, None, None]
        ridge = penalty[:, :, None] * np.eye(columns.shape[2]) * seen
        weights = np.linalg.solve(sum(grams) - grams + ridge, (sum(products) - products)[..., None])
        squares = np.zeros(len(columns))
        for block, own, fitted in zip(blocks, targets, weights, strict=True):
            error = own - (block @ fitted)[..., 0]
            squares += np.einsum("pn,pn->p", error, error)
        return np.asarray(np.sqrt(squares / len(target)))


def cross_validated_rms(columns: Array, target: Array, penalty: Array, folds: NDArray[np.int64]) -> Array:
    """Return the RMS error on left-out folds of a population of ridge fits, shape (p,), rows in any order.

    columns: (p, n, k). target: (n,). penalty: (p, k). folds: (n,), 0 to the number of folds - 1.
    """
    sorted_rows = LeftOutFolds.of(folds)
    return sorted_rows.rms(columns[:, sorted_rows.order], target[sorted_rows.order], penalty)
