"""Tables of a training."""

import numpy as np

from hgma_compensation.report import training_sentences as sentences
from hgma_compensation.report.cards import badge
from hgma_compensation.report.markup import Html, element, table
from hgma_compensation.report.pictures.ramps import DIRECTIONS, direction
from hgma_compensation.report.pictures.training import METHODS
from hgma_compensation.report.training_result import TrainedChannel, TrainingResult
from hgma_compensation.report.words import SPACE, duration, instant, number, quantity, unit
from hgma_compensation.training.comparison import MethodResult


def overview(result: TrainingResult) -> Html:
    """Return one line for each channel."""
    rows = []
    for index, channel in enumerate(result.channels):
        kind = sentences.kind(channel)
        rows.append(
            [
                element("a", channel.name, href=f"#channel-{index}"),
                badge(kind, sentences.BADGES[kind]),
                quantity(channel.chosen.fit, channel.name),
                quantity(channel.chosen.cross_validated, channel.name),
                quantity(channel.calibration.error.noise, channel.name),
            ]
        )
    return table(("channel", "verdict", "fitted", "left out", "noise of the means"), rows, numbers=(2, 3, 4))


def comparison(channel: TrainedChannel) -> Html:
    """Return every method with its errors and the time it took."""
    rows = []
    for result in channel.results:
        times = sentences.times_noise(channel, result.cross_validated)
        name = METHODS[result.method][1]
        rows.append(
            [
                element("strong", f"{name} (chosen)") if result is channel.chosen else name,
                number(result.cross_validated),
                "–" if times is None else f"{number(times)} ×",
                number(result.fit),
                "–" if result.seconds is None else _took(result.seconds),
            ]
        )
    of = unit(channel.name)
    heads = ("method", f"left out, {of}", "left out / noise", f"fitted, {of}", "took")
    return table(heads, rows, numbers=(1, 2, 3, 4), compact=True)


def _took(seconds: float) -> str:
    return duration(seconds) if seconds >= 1.0 else f"{number(1000.0 * seconds, 2)}{SPACE}ms"


def folds(result: TrainingResult, channel: TrainedChannel) -> Html:
    """Return the errors of every method on every fold left out."""
    means = np.bincount(result.folds.index, minlength=result.folds.count)
    errors = [each.of_folds(result.folds) for each in channel.results]
    rows = [
        [str(fold + 1), str(int(means[fold])), *(number(own[fold]) for own in errors)]
        for fold in range(result.folds.count)
    ]
    heads = ("fold", "means", *(_head(each, channel) for each in channel.results))
    return table(heads, rows, numbers=tuple(range(len(heads))))


def _head(result: MethodResult, channel: TrainedChannel) -> str:
    return f"{result.method.value}, {unit(channel.name)}"


def covered(result: TrainingResult) -> Html:
    """Return which temperatures and rates were recorded in which direction, and for how long."""
    temperature, rate = result.blocks.features[:, 0], result.blocks.features[:, 1]
    way, block = direction(rate), float(result.calibration.training["block"])
    rows = []
    for _, text, sign in DIRECTIONS:
        mine = way == sign
        if mine.any():
            rows.append(
                [
                    text,
                    duration(block * int(mine.sum())),
                    _range(temperature[mine], "°C"),
                    _range(60.0 * rate[mine], "°C/min"),
                ]
            )
    return table(("direction", "for", "temperature", "rate (middle 90 %)"), rows, compact=True)


def _range(values: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]", of: str) -> str:
    low, high = (values.min(), values.max()) if of == "°C" else np.quantile(values, (0.05, 0.95))
    return f"{number(float(low))} to {number(float(high))}{SPACE}{of}"


def recordings(result: TrainingResult) -> Html:
    """Return what was trained on."""
    rows = [
        [one["name"], instant(one["start"]), duration(one["duration"]), str(one["samples"])]
        for one in result.calibration.training["recordings"]
    ]
    return table(("recording", "begins", "lasts", "samples"), rows, numbers=(2, 3), compact=True)
