"""Radial-basis-function network, Eqs. (3) to (5) of Zhu et al. 2019, with linear terms beside it."""

from dataclasses import dataclass

import numpy as np

from hgma_compensation.drift.inputs import Array, InputScaling, weighted_sum


def hidden_layer(inputs: Array, centres: Array, widths: Array) -> Array:
    """Return the Gaussian layer, Eq. (3): exp(-|x - c|² / 2σ²) with a width for each input.

    inputs: (..., n, d). centres, widths: (..., m, d), widths > 0. Result: (..., n, m). Leading axes
    are populations of networks. Summed input by input, so that each element is computed alike
    whatever stands beside it.
    """
    exponent = np.zeros(
        (*np.broadcast_shapes(inputs.shape[:-2], centres.shape[:-2]), inputs.shape[-2], centres.shape[-2])
    )
    for k in range(inputs.shape[-1]):
        distance = (inputs[..., :, None, k] - centres[..., None, :, k]) / widths[..., None, :, k]
        exponent += distance * distance
    exponent *= -0.5
    return np.exp(exponent, out=exponent)


def basis(inputs: Array, centres: Array, widths: Array) -> Array:
    """Return the regressors [hidden layer, 1, inputs], shape (..., n, m + 1 + d)."""
    hidden = hidden_layer(inputs, centres, widths)
    rows = hidden.shape[:-1]
    return np.concatenate([hidden, np.ones((*rows, 1)), np.broadcast_to(inputs, (*rows, inputs.shape[-1]))], axis=-1)


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
