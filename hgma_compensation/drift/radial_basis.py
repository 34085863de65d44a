"""Radial-basis-function network, Eqs. (3) to (5) of Zhu et al. 2019, with linear terms beside it."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.drift.inputs import Array, InputScaling, weighted_sum


def gaussians(inputs: Array, centres: Array, widths: Array) -> Array:
    """Return the Gaussian layer, Eq. (3): exp(-|x - c|² / 2σ²) with a width for each input.

    inputs: (..., n, d). centres, widths: (..., m, d), widths > 0. Result: (..., m, n), a row for each
    Gaussian: elementwise loops are fast along the samples, of which there are many. Leading axes are
    populations of networks. Summed input by input, so that each element is computed alike whatever
    stands beside it.
    """
    exponent = _squared_distance(inputs, centres, widths, 0)
    for k in range(1, inputs.shape[-1]):
        exponent += _squared_distance(inputs, centres, widths, k)
    exponent *= -0.5
    return np.exp(exponent, out=exponent)


def _squared_distance(inputs: Array, centres: Array, widths: Array, k: int) -> Array:
    """Return the squared distances (..., m, n) along input k, in widths."""
    distance = np.asarray(inputs[..., None, :, k] - centres[..., k, None])
    distance /= widths[..., k, None]
    distance *= distance
    return distance


def hidden_layer(inputs: Array, centres: Array, widths: Array) -> Array:
    """Return ``gaussians`` of the same arguments with a row for each sample, shape (..., n, m)."""
    return np.ascontiguousarray(gaussians(inputs, centres, widths).swapaxes(-1, -2))


def basis(inputs: Array, centres: Array, widths: Array) -> Array:
    """Return the regressors [hidden layer, 1, inputs], shape (..., n, m + 1 + d)."""
    hidden = gaussians(inputs, centres, widths).swapaxes(-1, -2)
    m, d = hidden.shape[-1], inputs.shape[-1]
    columns = np.empty((*hidden.shape[:-1], m + 1 + d))
    columns[..., :m] = hidden
    columns[..., m] = 1.0
    columns[..., m + 1 :] = inputs
    return columns


@dataclass(frozen=True)
class RadialBasisDrift:
    """Drift = w·R(x) + b + a·x, Eqs. (4) and (5) with the linear term added.

    centres, widths: (m, d) in scaled inputs. weights (m,), bias, linear (d,) in the channel's unit.
    """

    scaling: InputScaling
    centres: Array
    widths: Array
    weights: Array
    bias: float
    linear: Array

    @property
    def coefficients(self) -> Array:
        """All that multiplies the columns of ``basis``, shape (m + 1 + d,)."""
        return np.concatenate([self.weights, [self.bias], self.linear])

    def evaluate(self, features: Array) -> Array:
        """Return the drift, shape (n,), at features of shape (n, d)."""
        columns = basis(self.scaling.apply(features), self.centres, self.widths)
        return weighted_sum(columns, self.coefficients)
