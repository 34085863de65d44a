"""Tables of an evaluation."""

from hgma_compensation.evaluation.evaluate import ChannelEvaluation, Evaluation
from hgma_compensation.report import evaluation_sentences as sentences
from hgma_compensation.report.cards import badge
from hgma_compensation.report.markup import Html, element, table
from hgma_compensation.report.run_record import RunSummary
from hgma_compensation.report.words import SPACE, duration, instant, number, quantity, unit


def overview(evaluation: Evaluation) -> Html:
    """Return one line for each channel."""
    rows = []
    for index, channel in enumerate(evaluation.channels):
        kind, times = sentences.kind(channel), sentences.times_noise(channel)
        rows.append(
            [
                element("a", channel.name, href=f"#channel-{index}"),
                badge(kind, sentences.BADGES[kind]),
                quantity(channel.raw.rms_error, channel.name),
                quantity(channel.compensated.rms_error, channel.name),
                quantity(channel.noise_floor, channel.name),
                "–" if times is None else f"{number(times)} ×",
            ]
        )
    heads = ("channel", "verdict", "raw error", "compensated", "noise of the means", "compensated / noise")
    return table(heads, rows, numbers=(2, 3, 4, 5))


def figures(channel: ChannelEvaluation) -> Html:
    """Return all figures of a channel with their units."""
    raw, after, of = channel.raw, channel.compensated, unit(channel.name)
    rows = [
        _row(f"RMS error of means over 5{SPACE}s, {of}", raw.rms_error, after.rms_error),
        _row(f"span, {of}", raw.span, after.span),
        _row(f"velocity random walk N, {of}/√Hz", raw.velocity_random_walk, after.velocity_random_walk),
        _row(f"bias instability B, {of}", raw.bias_instability, after.bias_instability),
        [f"noise of a mean over 5{SPACE}s, {of}", number(channel.noise_floor), "–", "–"],
        ["samples", str(raw.samples), str(after.samples), "–"],
    ]
    return table(("figure", "raw", "compensated", "ratio"), rows, numbers=(1, 2, 3), compact=True)


def _row(name: str, raw: float | None, after: float | None) -> list[str]:
    ratio = number(raw / after) if raw is not None and after else "–"
    return [name, *("–" if value is None else number(value) for value in (raw, after)), ratio]


def recording(evaluation: Evaluation, summary: RunSummary, name: str, reference: str) -> Html:
    """Return what was evaluated."""
    temperature = evaluation.channels[0].temperature
    span = f"{number(float(temperature.min()))} to {number(float(temperature.max()))}{SPACE}°C"
    rate = f"{number(1.0 / summary.interval)}{SPACE}Hz" if summary.interval > 0.0 else "–"
    rows = [
        ["recording", name],
        ["begins", instant(summary.start)],
        ["lasts", duration(summary.duration)],
        ["samples", f"{summary.samples} ({rate})"],
        ["temperature", span],
        ["reference", "the recording’s own mean" if reference == "mean" else reference],
    ]
    return table(("what", "value"), rows)
