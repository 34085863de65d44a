"""The sensing structure in three-dimensional finite elements of anisotropic silicon, to judge the beam theory by.

A quarter of the structure, bricks of 27 nodes (quadratic in each direction, 3 × 3 × 3 Gauss points), beams clamped
at their outer ends. x and y along <110>, z along <001>; elastic constants of Hopcroft, Nix, Kenny 2010.
"""

from itertools import product

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh

Array = NDArray[np.float64]

C11, C12, C44, DENSITY = 165.7e9, 63.9e9, 79.6e9, 2330.0
BRICK = np.array([50e-6, 50e-6, 80e-6])
MASS, BEAM, LAYERS = 8, 7, 5
"""Bricks: half the side of the mass, length of a beam, height of the mass. A beam is one brick thick."""


def _stiffness_of_silicon() -> Array:
    along, across, shear = 0.5 * (C11 + C12) + C44, 0.5 * (C11 + C12) - C44, 0.5 * (C11 - C12)
    matrix = np.diag([along, along, C11, C44, C44, shear])
    matrix[0, 1] = matrix[1, 0] = across
    matrix[:2, 2] = matrix[2, :2] = C12
    return matrix


def _brick() -> tuple[Array, Array]:
    """Return stiffness and mass (81, 81) of a brick."""
    stiffness, mass, elastic = np.zeros((81, 81)), np.zeros((81, 81)), _stiffness_of_silicon()
    points = zip((-np.sqrt(0.6), 0.0, np.sqrt(0.6)), (5 / 9, 8 / 9, 5 / 9), strict=True)
    for point in product(list(points), repeat=3):
        lines = [np.array([u * (u - 1) / 2, 1 - u * u, u * (u + 1) / 2]) for u, _ in point]
        slopes = [np.array([u - 0.5, -2 * u, u + 0.5]) * 2.0 / size for (u, _), size in zip(point, BRICK, strict=True)]
        volume = np.prod([weight for _, weight in point]) * np.prod(BRICK) / 8.0
        shape = np.einsum("i,j,k->ijk", *lines).ravel()
        dx, dy, dz = (
            np.einsum("i,j,k->ijk", *(slopes[a] if a == axis else lines[a] for a in range(3))).ravel()
            for axis in range(3)
        )
        strain = np.zeros((6, 27, 3))
        strain[[0, 5, 4], :, 0], strain[[1, 5, 3], :, 1], strain[[2, 4, 3], :, 2] = (
            (dx, dy, dz),
            (dy, dx, dz),
            (dz, dx, dy),
        )
        strain = strain.reshape(6, 81)
        stiffness += strain.T @ elastic @ strain * volume
        mass += DENSITY * volume * np.kron(np.outer(shape, shape), np.eye(3))
    return stiffness, mass


def first_frequency(beam_layer: int, *, rocking: bool) -> float:
    """Return the lowest frequency (Hz): up and down, or rocking. beam_layer: bricks of the mass below the beams."""
    reach = MASS + BEAM
    bricks = np.array(
        [
            (i, j, k)
            for i, j, k in product(range(reach), range(reach), range(LAYERS))
            if (i < MASS and j < MASS) or (k == beam_layer and (i < MASS or j < MASS))
        ]
    )
    nodes = 2 * bricks[:, None, :] + np.array(list(product(range(3), repeat=3)))[None]
    places, numbers = np.unique(nodes.reshape(-1, 3), axis=0, return_inverse=True)
    dofs = (3 * numbers.reshape(len(bricks), 27, 1) + np.arange(3)).reshape(len(bricks), 81)
    rows, columns = np.repeat(dofs, 81, axis=1).ravel(), np.tile(dofs, (1, 81)).ravel()
    free = ~_held(places, 2 * reach, rocking).ravel()
    stiffness, mass = (
        sp.csc_matrix((np.tile(part.ravel(), len(bricks)), (rows, columns)))[free][:, free] for part in _brick()
    )
    value = eigsh(stiffness, 1, mass, sigma=0.0, v0=np.ones(stiffness.shape[0]), return_eigenvectors=False)[0]
    return float(np.sqrt(value) / (2.0 * np.pi))


def _held(places: NDArray[np.int64], end: int, rocking: bool) -> NDArray[np.bool_]:
    """Return which displacements (n, 3) are zero: clamped ends, and the symmetry of the motion."""
    held = np.zeros((len(places), 3), dtype=bool)
    held[(places[:, 0] == end) | (places[:, 1] == end)] = True
    middle = places[:, 0] == 0
    held[np.ix_(middle, [1, 2] if rocking else [0])] = True
    held[places[:, 1] == 0, 1] = True
    return held
