"""A Cholesky factor by panels of its columns: half the memory of the matrix, and a file where it is not in use."""

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import dgemm, dgemv
from scipy.linalg.lapack import dtrtrs

from hgma_compensation.recording.sliced import in_parts
from hgma_compensation.recording.spooled import Spooled

Array = NDArray[np.float64]
Panel: TypeAlias = tuple[Array, Array]
"""Of the columns of a panel the square on the diagonal (w, w), and the rows below it (m, w); by Fortran's columns."""

WIDTH, STRIP = 256, 64
"""Columns that are taken off what is below at once, of many right sides and of one. These are OpenBLAS's own on the
processors of a PC, where no bit differs from a solution in one piece; elsewhere the order of the sums may be another
one, which changes 1e-14 of the largest element at most in tests."""

WHOLE = 512
"""Rows up to which a factor is one panel."""

WRITTEN = 16
"""Columns that are written at once."""


class Factor:
    """A lower triangular matrix (n, n) that equations are solved with.

    A large one waits in a file without a name, and is in memory from its first use until it is put away. Then each use
    reads it panel by panel.
    """

    def __init__(self, lower: Array) -> None:
        """Take the matrix (n, n); what is above its diagonal is not looked at."""
        self._size = len(lower)
        self._width = self._size if self._size <= WHOLE else WIDTH
        self._file: Spooled | None = None
        self._held: list[Panel] | None = None
        self._used = True
        if self._size <= WHOLE:
            self._held = list(self._cut(np.asfortranarray(lower)))
        else:
            # By way of the file, so that the panels are not in memory beside the matrix.
            self._file = _filed(self._cut(lower))

    def solve(self, columns: Array, *, held: bool = True) -> Array:
        """Return L⁻¹ columns; (n,) or (n, k). held: whether the factor stays in memory for the next ones."""
        rest = np.array(columns, order="F")
        white, done = np.empty_like(rest), 0
        for square, below in self._panels(held):
            width = len(square)
            head = dtrtrs(square, rest[:width], lower=1)[0].reshape(rest[:width].shape)
            white[done : done + width] = head
            done += width
            rest = _without(rest[width:], below, head)
            del square, below  # before the next ones are read
        return white

    def transposed(self, columns: Array) -> Array:
        """Return Lᵀ columns, (n, k)."""
        product, done = np.empty_like(columns), 0
        for square, below in self._panels():
            end = done + len(square)
            product[done:end] = np.concatenate([square, below]).T @ columns[done:]
            del square, below
            done = end
        return product

    @property
    def diagonal(self) -> Array:
        """Return the diagonal (n,)."""
        return np.concatenate([np.diag(square) for square, _ in self._panels()])

    def read(self) -> Array:
        """Return the matrix (n, n), zero above its diagonal."""
        matrix, done = np.zeros((self._size, self._size), order="F"), 0
        for square, below in self._panels():
            end = done + len(square)
            matrix[done:end, done:end] = np.tril(square)
            matrix[end:, done:end] = below
            done = end
        return matrix

    def put_away(self) -> None:
        """Leave it in the file from now on."""
        if self._file is None and self._held is not None:
            self._file = _filed(iter(self._held))
        self._held, self._used = None, False

    def _cut(self, lower: Array) -> Iterator[Panel]:
        for part in in_parts(self._size, self._width):
            yield lower[part, part], lower[part.stop :, part]

    def _panels(self, held: bool = True) -> Iterator[Panel]:
        if self._file is not None and not (held and self._used):
            self._held = None
            return self._read()
        if self._held is None:
            self._held = list(self._read())
        return iter(self._held)

    def _read(self) -> Iterator[Panel]:
        assert self._file is not None
        done = 0
        for part in in_parts(self._size, self._width):
            width, below = part.stop - part.start, self._size - part.stop
            edges = done, done + width * width, done + width * (width + below)
            yield (
                self._file[edges[0] : edges[1]].reshape((width, width), order="F"),
                self._file[edges[1] : edges[2]].reshape((below, width), order="F"),
            )
            done = edges[2]


def _filed(panels: Iterator[Panel]) -> Spooled:
    numbers = Spooled(1)
    for panel in panels:
        for block in panel:
            # A few columns at a time: copies of panels, each of another size, would each take other free memory.
            for part in in_parts(block.shape[1], WRITTEN):
                numbers.add(np.ascontiguousarray(block[:, part].T).reshape(-1, 1))
    return numbers


def _without(rest: Array, below: Array, head: Array) -> Array:
    """Return what is left of rows (m,) or (m, k) once those above them are known."""
    if not len(rest):
        return rest
    if head.ndim == 2 and head.shape[1] != 1:
        return np.asarray(dgemm(-1.0, below, head, beta=1.0, c=rest))
    left, known = rest.reshape(-1).copy(), head.reshape(-1)
    for part in in_parts(len(known), STRIP):
        left = dgemv(-1.0, below[:, part], known[part], beta=1.0, y=left, overwrite_y=1)
    return np.asarray(left.reshape(rest.shape))
