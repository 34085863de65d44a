"""A training in plain words."""

import numpy as np

from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.quantities import counted
from hgma_compensation.report.cards import command
from hgma_compensation.report.markup import inner
from hgma_compensation.report.pictures.ramps import direction, still_rate
from hgma_compensation.report.pictures.training import METHODS
from hgma_compensation.report.sentences import NOTABLY_ABOVE
from hgma_compensation.report.training_result import TrainedChannel, TrainingResult
from hgma_compensation.report.words import SPACE, number, quantity
from hgma_compensation.training.methods import GAIN, STRAIGHT, Method

BETTER = 0.9
"""Share of the chosen method's error below which another one's is worth a sentence."""

NARROWER = 0.8
"""Share of the span of temperature that heating and cooling should each cover."""

ALIKE = 1.25
"""Ratio of the fastest to the slowest usual ramp below which there is one rate only."""

SHORT_SOAK = 300.0
"""s of soaking below which a memory has no time to fade."""

BADGES = {"good": "down to the noise", "calm": "some drift is left", "bad": "another method is better"}


def times_noise(channel: TrainedChannel, error: float) -> float | None:
    """Return an error over the noise of the means, None where there are too few means to tell."""
    noise = channel.calibration.error.noise
    return error / noise if noise > 0.0 else None


def kind(channel: TrainedChannel) -> str:
    """Return good where noise is left, bad where another method is better, else calm."""
    times = times_noise(channel, channel.chosen.cross_validated)
    if times is not None and times <= NOTABLY_ABOVE:
        return "good"
    return "bad" if channel.best.cross_validated < BETTER * channel.chosen.cross_validated else "calm"


def headline(channel: TrainedChannel, folds: str) -> str:
    """Return the main thing; folds: what a fold is."""
    error = channel.chosen.cross_validated
    times = times_noise(channel, error)
    beside = "" if times is None else f", {number(times, 2)}{SPACE}× the noise of the means"
    return (
        f"On {folds} that it has not seen, the {_name(channel.method)} leaves {quantity(error, channel.name)}{beside}."
    )


def why(channel: TrainedChannel) -> list[str]:
    """Return what was chosen and why, and what this does not show."""
    said = [_beside_the_cubic(channel)]
    if channel.method is Method.RBF_GA:
        said += [_shape(channel), _end(channel)]
        said.append(
            "The choice among networks looked at this very error, which is therefore a little too small: judge on a "
            "recording that was not trained on."
        )
    best = channel.best
    if best.cross_validated < BETTER * channel.chosen.cross_validated:
        less = f"On the same folds the {_name(best.method)} leaves less, {quantity(best.cross_validated, channel.name)}"
        said.append(inner(f"{less}: train with ", command(f"--method {best.method.value}"), "."))
    return [one for one in said if one]


def _name(method: Method) -> str:
    return METHODS[method][1]


def _beside_the_cubic(channel: TrainedChannel) -> str:
    cubic, error = channel.results[0], channel.chosen.cross_validated
    if channel.method is cubic.method or error <= 0.0:
        return ""
    ratio = cubic.cross_validated / error
    compared = (
        f"{number(ratio, 2)} times as much" if ratio > 1.0 / BETTER else "about as much" if ratio > BETTER else "less"
    )
    return f"A cubic in temperature, as PX4 and ArduPilot fit it, leaves {compared} on the same folds."


def _shape(channel: TrainedChannel) -> str:
    drift = channel.calibration.drift
    if not isinstance(drift, RadialBasisDrift):
        return ""
    straight = bool(np.all(drift.widths[:, 1:] >= STRAIGHT[0] * (1.0 - 1e-9)))
    size = f"{len(drift.weights)} Gaussians"
    margin = f"{round(100.0 * GAIN)}{SPACE}%"
    if straight:
        return (
            f"The network ({size}) bends with the temperature and answers to its rate in proportion: curvature in the "
            f"rate did not lower the error on left-out folds by {margin}, or was not needed to reach the noise."
        )
    return (
        f"The network ({size}) bends in the rate too, which lowers the error on left-out folds by more than {margin}."
    )


def _end(channel: TrainedChannel) -> str:
    if not len(channel.search) or channel.search[-1] > channel.calibration.error.noise:
        return ""
    after = counted(len(channel.search), "generation")
    return f"The search ended after {after}, as the error had come down to the noise of the means."


def gaps(result: TrainingResult) -> list[str]:
    """Return what the recordings could not show, with the remedy."""
    temperature, rate = result.blocks.features[:, 0], result.blocks.features[:, 1]
    way, span = direction(rate), float(np.ptp(temperature))
    said = []
    for sign, text in ((1, "heat"), (-1, "cool")):
        own = temperature[way == sign]
        if not len(own):
            said.append(f"The recordings never {text}: lag and hysteresis cannot be told from drift. Record both ways.")
        elif float(np.ptp(own)) < NARROWER * span:
            said.append(
                f"They {text} over {_span(own)} only, of {_span(temperature)}: elsewhere the other direction "
                "stands for both."
            )
    fast = np.abs(rate[np.abs(rate) > still_rate(rate)])
    if len(fast) and float(np.quantile(fast, 0.9)) < ALIKE * float(np.quantile(fast, 0.25)):
        said.append(
            f"Nearly all ramps have one rate, {number(60.0 * float(np.median(fast)), 2)}{SPACE}°C/min: what another "
            "rate does is a guess. Record a cycle at half or double the rate."
        )
    soak = float(np.count_nonzero(way == 0)) * float(result.calibration.training["block"])
    if soak < SHORT_SOAK:
        said.append("The temperature is hardly ever held: record soaks of 15 min at both ends, so that memories fade.")
    if result.folds.kind == "stretches of a single sweep":
        said.append(
            "There is a single sweep of temperature: what was left out is a part of the same sweep, and says little "
            "about the next one. Record at least two cycles."
        )
    return said or ["Both directions over the whole range, more than one rate, and soaks: nothing obvious is missing."]


def _span(values: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]") -> str:
    return f"{number(float(values.min()))} to {number(float(values.max()))}{SPACE}°C"
