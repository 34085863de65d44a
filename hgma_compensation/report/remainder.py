"""What structure that nothing carries looks like, in words."""

import numpy as np
from numpy.typing import NDArray

from hgma_compensation.diagnosis.lines import OVERSAMPLING, power_spectrum
from hgma_compensation.diagnosis.problem import State
from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.diagnosis.verdict import RARE, has_structure
from hgma_compensation.report.pictures.ramps import direction
from hgma_compensation.report.words import duration, quantity

Array = NDArray[np.float64]

SMOOTH, SHORT = 300.0, 60.0
"""s over which the residual is averaged before its shape is described, and before jumps are looked for."""

BESIDE, OUTSTANDING = 1.6, 8.0
"""Range of frequencies beside a line, and how far the line stands out of most of what is there."""

NOTABLE = 0.25
TWO_LEVELS = 0.82
"""Share of the variance that two levels explain, from which on it jumps; of a Gaussian they explain 0.64."""


def looks_like(channel: ChannelDiagnosis) -> list[str]:
    """Return sentences on what is left in the recordings that were learned from."""
    left = channel.residues_after if channel.judgement.helped else channel.residues_before
    places = [name for name, one in zip(("recordings", "hold-out"), left, strict=True) if has_structure(one)]
    excess = max(left[0].slow.excess, min(left[1].slow.excess, _beyond_noise(channel)))
    said = []
    if places:
        said.append(f"Its slow part is {quantity(excess, channel.name)} RMS beyond noise ({' and '.join(places)}).")
    state = channel.findings.state if channel.judgement.helped else channel.findings.before
    said += _shape(state)
    if min(one.line_p_value for one in left) < RARE:
        period = line_of(state)
        said += [f"It holds a line with a period of {duration(period)}."] if period else []
    return said


def _beyond_noise(channel: ChannelDiagnosis) -> float:
    """Return the RMS error of the calibration on the hold-out beyond noise, in the channel's unit.

    The baseline of a diagnosis is refitted, and bends away where a hold-out leaves the temperatures that it was fitted
    to; the calibration, which is held there, does not. So it bounds what can be said of the hold-out.
    """
    error = channel.error_after if channel.judgement.helped else channel.error_before
    return float(np.sqrt(max(error**2 - channel.noise_floor**2, 0.0)))


def line_of(state: State) -> float | None:
    """Return the period of the strongest line, s; None where it does not stand out from what is beside it."""
    frequencies, power = power_spectrum(state.problem, state.projection.residual)
    if not len(frequencies):
        return None
    peak = int(np.argmax(power))
    ratio = frequencies / frequencies[peak]
    apart = np.abs(np.arange(len(power)) - peak) > 2 * OVERSAMPLING
    beside = power[(ratio > 1.0 / BESIDE) & (ratio < BESIDE) & apart]
    if not len(beside) or power[peak] < OUTSTANDING * float(np.quantile(beside, 0.9)):
        return None
    return float(1.0 / frequencies[peak])


def _shape(state: State) -> list[str]:
    smooth = _smoothed(state, SMOOTH)
    shares = shares_of(state, smooth)
    said = [f"{round(100.0 * share)} % of its variance {text}." for text, share in shares.items() if share > NOTABLE]
    if two_levels(_smoothed(state, SHORT)) > TWO_LEVELS:
        said.append("It jumps between two levels.")
    if not said:
        said.append("It follows neither the temperature, nor its direction, nor the time in a simple way.")
    return said


def _smoothed(state: State, seconds: float) -> Array:
    """Return the residual (n,), averaged over so many seconds within each recording."""
    _, residual = state.fit()
    run = state.problem.scene.blocks.run
    size = max(1, round(seconds / state.problem.block))
    smooth = residual.copy()
    for number in np.unique(run):
        own = residual[run == number]
        window = np.ones(min(size, len(own)))
        smooth[run == number] = np.convolve(own, window, "same") / np.convolve(np.ones(len(own)), window, "same")
    return smooth


def shares_of(state: State, smooth: Array) -> dict[str, float]:
    """Return the share of the variance of a residual (n,) that simple descriptions carry, by their words."""
    blocks, features = state.problem.scene.blocks, state.problem.features
    numbers = np.unique(blocks.run)
    levels = (blocks.run[:, None] == numbers).astype(float)
    offsets = _carried(levels, smooth)
    trends = np.empty((len(smooth), 0))
    for number in numbers:
        mine = blocks.run == number
        time = (blocks.stamps - blocks.stamps[mine][0]) * 1e-9
        place = np.where(mine, 2.0 * time / max(float(time[mine][-1]), 1.0) - 1.0, 0.0)
        trends = np.column_stack([trends, *(np.where(mine, place**power, 0.0) for power in (1, 2, 3))])
    temperature = _bins(features[:, 0], 15)
    way = direction(features[:, 1])
    loops = np.hstack([temperature * (way == sign)[:, None] for sign in (1, -1)])
    return {
        "lies in offsets between the recordings": offsets,
        "is a slow change with time inside of each recording": _carried(np.hstack([levels, trends]), smooth) - offsets,
        "goes with the temperature": _carried(temperature, smooth),
        "goes with the direction of the ramp (a loop)": _carried(np.hstack([temperature, loops]), smooth)
        - _carried(temperature, smooth),
    }


def _bins(values: Array, count: int) -> Array:
    edges = np.linspace(values.min(), values.max(), count + 1)
    place = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, count - 1)
    return np.eye(count)[place]


def _carried(columns: Array, values: Array) -> float:
    weights, *_ = np.linalg.lstsq(columns, values, rcond=None)
    return float(1.0 - np.mean((values - columns @ weights) ** 2) / max(float(np.mean(values**2)), 1e-300))


def two_levels(values: Array) -> float:
    """Return the share of the variance of values (n,) that the best two levels explain."""
    ordered = np.sort(values)
    count = np.arange(1, len(ordered))
    left = np.cumsum(ordered)[:-1]
    between = (left / count - (ordered.sum() - left) / (len(ordered) - count)) ** 2
    share = between * count * (len(ordered) - count) / len(ordered) ** 2
    return float(share.max(initial=0.0) / max(float(ordered.var()), 1e-300))
