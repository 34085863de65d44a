"""The page of ``hgma evaluate --report``."""

from pathlib import Path

from hgma_compensation import __version__
from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.evaluation.evaluate import ChannelEvaluation, Evaluation
from hgma_compensation.files import write_atomically
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.report import evaluation_sentences as sentences
from hgma_compensation.report.cards import badge, charts, tile, verdict
from hgma_compensation.report.evaluation_next import Evaluated, next_step
from hgma_compensation.report.evaluation_tables import figures, overview, recording
from hgma_compensation.report.markup import Html, bullets, element, inner, paragraphs
from hgma_compensation.report.page import page, section
from hgma_compensation.report.pictures.allan import allan_chart
from hgma_compensation.report.pictures.decimate import MOST
from hgma_compensation.report.pictures.errors import error_charts
from hgma_compensation.report.run_record import RunSummary
from hgma_compensation.report.trained_on import TrainedOn, trained_on
from hgma_compensation.report.words import SPACE, number

POINTS = 24_000
"""Of all series on the page together, which bounds its size to about 1 MB."""

SERIES = 8
"""Of each channel."""

HOW = (
    "Errors are those of means over 5 s against the reference, compensated as the node does it. The noise of the means "
    "is read from their second differences, which no slow drift enters. N is read at the shortest averaging time, B at "
    "the smallest Allan deviation (over 0.664): an upper bound, and of no meaning while the sensor moves. Span is the "
    "largest less the smallest mean."
)


def write_evaluation_report(
    evaluation: Evaluation, summary: RunSummary, calibration: Calibration, about: Evaluated, path: Path
) -> None:
    """Write the report as one page that needs no network; it appears whole or not at all.

    Raises RefusedError where the page cannot be written.
    """
    write_atomically(path, evaluation_page(evaluation, summary, calibration, about).encode())


def evaluation_page(evaluation: Evaluation, summary: RunSummary, calibration: Calibration, about: Evaluated) -> str:
    """Return the report as HTML."""
    count = len(evaluation.channels)
    first = [section("All channels", overview(evaluation), level=2)] if count > 1 else []
    known = trained_on(calibration, about.name, summary.start, summary.end)
    channels = [_channel(index, evaluation, summary, calibration, about, known) for index in range(count)]
    return page(
        f"Evaluation of {about.name}",
        _head(calibration, about, known),
        *first,
        *channels,
        _judged(evaluation, summary, about, known),
    )


def _head(calibration: Calibration, about: Evaluated, known: TrainedOn) -> Html:
    warning = element("p", element("strong", known.said)) if known.certain else Html("")
    return element(
        "header",
        element("h1", f"Evaluation of {about.name}"),
        element(
            "p", inner("Sensor ", calibration.sensor_id, ", calibration ", element("code", calibration.calibration_id))
        ),
        warning,
    )


def _channel(
    index: int,
    evaluation: Evaluation,
    summary: RunSummary,
    calibration: Calibration,
    about: Evaluated,
    known: TrainedOn,
) -> Html:
    channel, curves = evaluation.channels[index], summary.curves[index]
    most = min(MOST, POINTS // (SERIES * len(evaluation.channels)))
    kind = sentences.kind(channel)
    noise = (
        charts([allan_chart(channel, curves)]) if curves else element("p", "Too few samples for an Allan deviation.")
    )
    filtered = calibration.channels[index].filter.mode
    remark = (
        element(
            "p", f"The Kalman stage ({filtered.value}) shapes the compensated curve at short times.", class_="quiet"
        )
        if filtered is not FilterMode.OFF
        else Html("")
    )
    head = element("header", element("h2", channel.name), badge(kind, sentences.BADGES[kind]))
    return element(
        "article",
        head,
        _verdict(channel, summary, about, known),
        section("Error against time and temperature", charts(error_charts(channel, most))),
        section("Noise", noise, remark),
        section("Figures", figures(channel)),
        class_="channel",
        id=f"channel-{index}",
    )


def _verdict(channel: ChannelEvaluation, summary: RunSummary, about: Evaluated, known: TrainedOn) -> Html:
    largest = max(channel.raw.rms_error, channel.compensated.rms_error, channel.noise_floor)
    times = sentences.times_noise(channel)
    beside = f"{number(times)}{SPACE}× the noise" if times is not None else ""
    tiles = [
        tile("raw error", channel.raw.rms_error, channel.name, "before", largest=largest),
        tile("compensated", channel.compensated.rms_error, channel.name, "after", largest=largest, beside=beside),
        tile("noise of the means", channel.noise_floor, channel.name, "soak", largest=largest),
    ]
    return verdict(
        sentences.kind(channel),
        sentences.headline(channel),
        paragraphs([*sentences.remarks(channel), *sentences.outside(summary)]),
        element("p", *next_step(channel, summary, about, known)),
        element("ul", *tiles, class_="tiles"),
        element("p", "RMS of means over 5 s.", class_="quiet"),
    )


def _judged(evaluation: Evaluation, summary: RunSummary, about: Evaluated, known: TrainedOn) -> Html:
    return element(
        "article",
        section(
            "The recording",
            element("p", known.said),
            recording(evaluation, summary, about.name, about.reference),
            bullets(sentences.coverage(summary)),
            level=2,
        ),
        section(
            "How it was judged", element("p", HOW), element("p", f"Made by hgma_compensation {__version__}."), level=2
        ),
        class_="channel",
    )
