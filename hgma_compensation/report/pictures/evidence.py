"""The part of the data that one effect is there for: what is left of the fit, and its own share of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import NDArray

from hgma_compensation.channels import CHANNELS
from hgma_compensation.diagnosis.blocks import Blocks
from hgma_compensation.diagnosis.forward import Candidate, Findings
from hgma_compensation.diagnosis.problem import State
from hgma_compensation.effects.effect import Effect
from hgma_compensation.report.pictures.ramps import direction

Array = NDArray[np.float64]

LEAST_SPAN = 0.5
"""°C below which there is no drift with temperature to take out."""

STATIC_DEGREE = 8
"""Of the polynomial in the temperature that stands for a drift model."""


@dataclass(frozen=True)
class View:
    """The blocks of a state, n of them, with the axes that they are drawn over."""

    channel: str
    state: State

    @property
    def blocks(self) -> Blocks:
        """The blocks."""
        return self.state.problem.scene.blocks

    @property
    def temperature(self) -> Array:
        """Temperature (n,), °C."""
        return self.state.problem.features[:, 0]

    @property
    def rate(self) -> Array:
        """Rate (n,), °C/s."""
        return self.state.problem.features[:, 1]

    @cached_property
    def direction(self) -> NDArray[np.int64]:
        """+1 heating, -1 cooling, 0 soak, (n,)."""
        return direction(self.rate)

    @cached_property
    def seconds(self) -> Array:
        """Time (n,) from the first block, s."""
        return np.asarray((self.blocks.stamps - self.blocks.stamps.min()) * 1e-9)

    @cached_property
    def recorded_hours(self) -> Array:
        """Time (n,) on an axis without the pauses between recordings, h."""
        steps = np.diff(self.seconds, prepend=self.seconds[:1])
        pause = np.diff(self.blocks.run, prepend=self.blocks.run[:1]) != 0
        return np.asarray(np.cumsum(np.where(pause, 10.0 * self.state.problem.block, steps)) / 3600.0)

    @property
    def runs(self) -> list[NDArray[np.int64]]:
        """Rows of each recording."""
        return [np.flatnonzero(self.blocks.run == number) for number in np.unique(self.blocks.run)]

    @cached_property
    def put_in(self) -> Array:
        """Mean (n,) of the channel less the drift model, in its unit: the acceleration that is really there."""
        return self.state.problem.scene.put_in[:, CHANNELS.index(self.channel)]

    @cached_property
    def since_power_on(self) -> Array:
        """Time (n,) since power came on, s."""
        since = np.empty(len(self.blocks))
        for rows in self.runs:
            run, still = int(self.blocks.run[rows[0]]), np.zeros((len(rows), len(CHANNELS)))
            since[rows] = self.state.problem.scene.conditions(run, self.blocks.stamps[rows], still).since_power_on
        return since


@dataclass(frozen=True)
class Evidence(View):
    """An effect of a fitted state. contribution, residual: (n,) of the blocks, in the channel's unit."""

    effect: Effect
    contribution: Array
    residual: Array
    stages: tuple[tuple[Candidate, ...], ...] = ()

    @property
    def partial(self) -> Array:
        """What the effect would have to carry, (n,): the residual of the whole fit and the effect's share of it."""
        return self.residual + self.contribution

    @property
    def columns(self) -> Array:
        """Columns (n, k) of the effect."""
        return self.state.columns[self.state.effects.index(self.effect)]

    @cached_property
    def static(self) -> Array:
        """The part (n,) of the contribution that any drift model over the temperature could carry."""
        if np.ptp(self.temperature) < LEAST_SPAN:
            return np.full(len(self.contribution), self.contribution.mean())
        degree = min(STATIC_DEGREE, len(np.unique(self.temperature)) - 1)
        return np.asarray(Chebyshev.fit(self.temperature, self.contribution, degree)(self.temperature))

    def rival(self, names: Sequence[str]) -> tuple[str, Array] | None:
        """Return the name of the best other kind out of names, and what it makes (n,) of ``partial`` in its place."""
        taken = {effect.name for effect in self.state.effects}
        tried = [c.scored for stage in self.stages for c in stage if c.scored.name in set(names) - taken]
        if not tried:
            return None
        best = min(tried, key=lambda scored: scored.bic).effect
        effects = [best if effect is self.effect else effect for effect in self.state.effects]
        _, residual = self.state.with_effects(effects, self.state.problem.columns(effects)).fit()
        return best.name, self.partial - residual


def evidence_of(findings: Findings, channel: str) -> list[Evidence]:
    """Return the evidence for each effect found, in their order."""
    state = findings.state
    weights, residual = state.fit()
    start = state.problem.baseline.shape[1]
    shares = []
    for columns in state.columns:
        shares.append(columns @ weights[start : start + columns.shape[1]])
        start += columns.shape[1]
    return [
        Evidence(channel, state, effect, share, residual, findings.stages)
        for effect, share in zip(state.effects, shares, strict=True)
    ]
