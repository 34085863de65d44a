"""What the findings are worth on data that nothing was fitted to."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, gamma

from hgma_compensation.diagnosis.leftover import SLOWEST
from hgma_compensation.diagnosis.lines import power_spectrum
from hgma_compensation.diagnosis.noise_fit import white_variance
from hgma_compensation.diagnosis.noise_model import qr_in_place, slow_cosines
from hgma_compensation.diagnosis.problem import Problem, State
from hgma_compensation.diagnosis.whitener import Whitener

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Residue:
    """What a fitted state leaves in some blocks, beside what noise and the uncertainty of the fit would.

    residual: (n,) in the channel's unit. whitener: of noise and uncertainty together. covariance: (n, n) in parts.
    noise: deviation of a mean of 10 s by white noise.
    """

    problem: Problem
    residual: Array
    whitener: Whitener
    noise: float

    @cached_property
    def white(self) -> Array:
        """Return the whitened residual (n,)."""
        return self.whitener(self.residual)

    @property
    def energy(self) -> float:
        """Whitened energy for each block: 1 on noise."""
        return float(np.mean(self.white**2))

    def energy_of(self, residual: Array) -> float:
        """Return the energy that another residual (n,) of the same blocks has under the same noise."""
        return float(np.mean(self.whitener(residual) ** 2))

    @cached_property
    def slow(self) -> "Slow":
        """Return its slow part."""
        blocks = self.problem.scene.blocks
        cosines = slow_cosines(blocks.run, blocks.stamps, SLOWEST)
        plain, _ = qr_in_place(np.array(cosines, order="F"))
        seen = float(np.sum((plain.T @ self.residual) ** 2))
        expected = self.whitener.expected(plain)
        del plain  # tens of megabytes of a day, as is what is white
        white = self.whitener(cosines)
        del cosines
        q, _ = qr_in_place(np.asfortranarray(white))
        energy = float(np.sum((q.T @ self.white) ** 2))
        return Slow(energy, q.shape[1], float(np.sqrt(max(seen - expected, 0.0) / len(self.residual))))

    @property
    def line_p_value(self) -> float:
        """Return the probability on noise of the strongest line of the spectrum."""
        frequencies, power = power_spectrum(self.problem, self.white)
        if not len(frequencies):
            return 1.0
        runs = len(np.unique(self.problem.scene.blocks.run))
        return float(min(1.0, len(frequencies) * gamma.sf(power.max() * runs, runs)))


@dataclass(frozen=True)
class Slow:
    """energy: whitened, over ``size`` degrees of freedom. excess: RMS beyond noise, in the channel's unit."""

    energy: float
    size: int
    excess: float

    @property
    def p_value(self) -> float:
        """Probability of that much on noise."""
        return float(chi2.sf(self.energy, max(self.size, 1)))


def residue(state: State, problem: Problem) -> Residue:
    """Return what a state, fitted to its own blocks, leaves in the blocks of another problem or its own."""
    other = np.hstack([problem.baseline, *problem.columns(state.effects)])
    weights, root = state.solution
    residual = problem.values - other @ weights
    blocks = problem.scene.blocks
    carried = np.abs(problem.slope(weights)) * problem.thermistor.deviation
    noise = replace(state.noise, white=white_variance(blocks, residual, carried), thermistor=carried)
    spread = None if problem is state.problem else other @ root
    whitener = noise.whitener(blocks.run, blocks.stamps, spread)
    whitener.put_away()  # a verdict asks each of them a few times only
    ten = float(np.sqrt(np.median(noise.white) * problem.block / 10.0))
    return Residue(problem, residual, whitener, ten)
