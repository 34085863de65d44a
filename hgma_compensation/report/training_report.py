"""The page of ``hgma train --report``."""

from collections.abc import Sequence
from pathlib import Path
from shlex import join, quote

from hgma_compensation import __version__
from hgma_compensation.files import write_atomically
from hgma_compensation.report import training_sentences as sentences
from hgma_compensation.report import training_tables as tables
from hgma_compensation.report.cards import badge, charts, command, tile, verdict
from hgma_compensation.report.markup import Html, bullets, details, element, inner, paragraphs
from hgma_compensation.report.page import page, section
from hgma_compensation.report.pictures.coverage import coverage_chart
from hgma_compensation.report.pictures.decimate import MOST
from hgma_compensation.report.pictures.training import comparison_chart, learned_charts, search_chart
from hgma_compensation.report.training_result import TrainedChannel, TrainingResult
from hgma_compensation.report.words import SPACE, number

POINTS = 20_000
"""Of all series on the page together, which bounds its size to about 1 MB."""

SERIES = 4
"""Of each channel."""

COMPARED = (
    "All methods were fitted to the same means, and again without each fold. Of the genetic search only the weights "
    "are fitted again: its Gaussians were chosen with sight of the errors on all folds. Where a fold leaves the range "
    "that the others have seen, nothing is held at the edge, as it would be by the node."
)

LIMITS = (
    "Nothing is known of temperatures and rates outside of those recorded. The calibration knows the sensor as it was "
    "on these days: aging, another mounting or another supply voltage are not in it."
)


def write_training_report(result: TrainingResult, bags: Sequence[Path], file: Path, path: Path) -> None:
    """Write the report as one page that needs no network; it appears whole or not at all.

    bags, file: recordings and calibration as the user named them. Raises RefusedError where it cannot be written.
    """
    write_atomically(path, training_page(result, bags, file).encode())


def training_page(result: TrainingResult, bags: Sequence[Path], file: Path) -> str:
    """Return the report as HTML."""
    count = len(result.channels)
    first = [section("All channels", tables.overview(result), level=2)] if count > 1 else []
    most = min(MOST, POINTS // (SERIES * count))
    channels = [_channel(result, index, most) for index in range(count)]
    calibration = result.calibration
    head = element(
        "header",
        element("h1", f"Training of {calibration.sensor_id}"),
        element("p", inner("Calibration ", element("code", calibration.calibration_id), f", in {file.name}")),
    )
    title = f"Training of {calibration.sensor_id}"
    return page(title, head, *first, *channels, _material(result), _next(result, bags, file))


def _channel(result: TrainingResult, index: int, most: int) -> Html:
    channel = result.channels[index]
    kind = sentences.kind(channel)
    head = element("header", element("h2", channel.name), badge(kind, sentences.BADGES[kind]))
    return element(
        "article",
        head,
        _verdict(result, channel),
        section("What was learned", charts(learned_charts(result.calibration, channel, most))),
        section(
            "Comparison of methods",
            charts([comparison_chart(channel, result.folds), *search_chart(channel, result.settings.generations)]),
            tables.comparison(channel),
            details("The same for every fold", tables.folds(result, channel)),
            element("p", COMPARED, class_="quiet"),
        ),
        class_="channel",
        id=f"channel-{index}",
    )


def _verdict(result: TrainingResult, channel: TrainedChannel) -> Html:
    chosen, noise = channel.chosen, channel.calibration.error.noise
    largest = max(chosen.fit, chosen.cross_validated, noise)

    def beside(error: float) -> str:
        times = sentences.times_noise(channel, error)
        return "" if times is None else f"{number(times)}{SPACE}× the noise"

    tiles = [
        tile("fitted", chosen.fit, channel.name, "before", largest=largest, beside=beside(chosen.fit)),
        tile(
            "left out",
            chosen.cross_validated,
            channel.name,
            "after",
            largest=largest,
            beside=beside(chosen.cross_validated),
        ),
        tile("noise of the means", noise, channel.name, "soak", largest=largest),
    ]
    block = float(result.calibration.training["block"])
    return verdict(
        sentences.kind(channel),
        sentences.headline(channel, result.folds.kind),
        paragraphs(sentences.why(channel)),
        element("ul", *tiles, class_="tiles"),
        element("p", f"RMS of means over {block:.3g} s; {result.calibration.training['folds']}.", class_="quiet"),
    )


def _material(result: TrainingResult) -> Html:
    return element(
        "article",
        section(
            "What the recordings cover",
            charts([coverage_chart(result.blocks.features, result.calibration.calibrated_range)], level=3),
            tables.covered(result),
            bullets(sentences.gaps(result)),
            level=2,
        ),
        section("The recordings", tables.recordings(result), level=2),
        class_="channel",
    )


def _next(result: TrainingResult, bags: Sequence[Path], file: Path) -> Html:
    calibration = quote(str(file))
    given = join(str(bag) for bag in bags)
    steps = [
        inner(
            "Judge it on a recording that it was not trained on: ",
            command(f"hgma evaluate ANOTHER_BAG --calibration {calibration} --report evaluation.html"),
        ),
        inner(
            "Where more than noise is left, let the effect be named that the model lacks: ",
            command(f"hgma diagnose {given} --calibration {calibration} --holdout ANOTHER_BAG -o diagnosis"),
        ),
        inner("Run it: ", command(f"hgma node --ros-args -p calibration_file:={calibration}")),
    ]
    training = result.calibration.training
    made = f"Method {training['method']}, seed {training['seed']}. Made by hgma_compensation {__version__}."
    return element(
        "article",
        section("What to do next", bullets(steps), level=2),
        section("Limits", element("p", LIMITS), element("p", made, class_="quiet"), level=2),
        class_="channel",
    )
