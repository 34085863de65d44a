"""What an effect that sees the temperature through a map is on a sensor whose map is its own drift."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.baseline import regressors
from hgma_compensation.diagnosis.problem import State, scaled_least_squares
from hgma_compensation.effects.effect import Effect
from hgma_compensation.effects.static_map import FINE, map_difference
from hgma_compensation.training.train import SMALLEST_SPAN

Array = NDArray[np.float64]


def shaped_by_drift(state: State, effects: Sequence[Effect]) -> dict[int, tuple[Effect, Array]]:
    """Return, for effects that see the temperature through a map, by index the form with a map that bends.

    Beside it what such an effect would be on a sensor whose map is the drift of the state: (n,), without a gain.
    """
    temperature = state.problem.features[:, 0]
    mapped = {i: effect for i, effect in enumerate(effects) if getattr(effect, "centres", None) == 0.0}
    if not mapped or np.ptp(temperature) < SMALLEST_SPAN:
        return {}
    weights, _ = state.fit()
    features = np.zeros_like(state.problem.features)
    features[:, 0] = temperature
    columns = regressors(state.problem.network, features)
    static = columns @ weights[: columns.shape[1]]
    low, high = float(temperature.min()), float(temperature.max())
    basis = map_difference(temperature, np.full(len(temperature), low), low, high, FINE)
    gains = scaled_least_squares(np.column_stack([basis, np.ones(len(basis))]), static)[:-1]
    fine = {i: _with_map(effect, low, high) for i, effect in mapped.items()}
    bent = state.problem.columns(list(fine.values()))
    return {i: (effect, own @ gains) for (i, effect), own in zip(fine.items(), bent, strict=True)}


def _with_map(effect: Effect, low: float, high: float) -> Effect:
    changed: Effect = replace(effect, centres=FINE, lowest=low, highest=high)  # type: ignore[type-var]
    return changed
