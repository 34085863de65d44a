"""All that the report says about one channel."""

import gc

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.diagnosis.result import ChannelDiagnosis, Diagnosis
from hgma_compensation.diagnosis.verdict import Verdict
from hgma_compensation.report import candidates, doubts, tables
from hgma_compensation.report.cards import charts, tile
from hgma_compensation.report.markup import Html, bullets, element, inner, paragraphs
from hgma_compensation.report.page import section
from hgma_compensation.report.pictures.by_effect import evidence_charts
from hgma_compensation.report.pictures.drift import drift_charts
from hgma_compensation.report.pictures.left import left_charts
from hgma_compensation.report.pictures.noise import allan_chart
from hgma_compensation.report.pictures.residuals import residual_charts
from hgma_compensation.report.pictures.spectrum import spectrum
from hgma_compensation.report.remainder import looks_like
from hgma_compensation.report.sentences import figures, headline, qualification, times_floor
from hgma_compensation.report.words import quantity


def channel_section(diagnosis: Diagnosis, index: int, original: Calibration | None) -> Html:
    """Return the section of a channel; original: the calibration that was diagnosed, where it is known."""
    channel = diagnosis.channels[index]
    parts = [
        _verdict(channel),
        section("Error on the hold-out", charts([*residual_charts(channel), *allan_chart(channel)])),
        *_evidence(channel),
        *_left(channel),
        _doubts(channel),
        section("All candidates", candidates.stages(channel)),
        _calibration(diagnosis, channel, original),
    ]
    head = element("header", element("h2", channel.name), tables.badge(channel))
    return element("article", head, *parts, class_="channel", id=f"channel-{index}")


def _verdict(channel: ChannelDiagnosis) -> Html:
    said = [figures(channel), qualification(channel)]
    if channel.verdict is Verdict.UNEXPLAINED:
        said += [" ".join(["What it looks like.", *looks_like(channel)]), doubts.advice(channel)]
    changed = channel.after is not channel.before
    tiles = [_tile("error before" if changed else "error", channel.error_before, channel, "before")]
    if changed:
        tiles.append(_tile("error after", channel.error_after, channel, "after"))
    tiles.append(_tile("noise floor", channel.noise_floor, channel, "soak"))
    return element(
        "section",
        element("p", headline(channel), class_="headline"),
        paragraphs(said),
        element("ul", *tiles, class_="tiles"),
        element("p", "RMS of means of 5 s on the hold-out, as the node would publish them.", class_="quiet"),
        class_=f"card verdict {channel.verdict.value}",
    )


def _tile(name: str, value: float, channel: ChannelDiagnosis, colour: str) -> Html:
    largest = max(channel.error_before, channel.error_after, channel.noise_floor)
    beside = f"{times_floor(channel, before=colour == 'before')} × the noise floor" if colour != "soak" else ""
    return tile(name, value, channel.name, colour, largest=largest, beside=beside)


def _evidence(channel: ChannelDiagnosis) -> list[Html]:
    found = evidence_charts(channel.findings, channel.name)
    parts = []
    for title, drawn in found:
        parts.append(inner(element("h4", title), charts(drawn, level=5)))
        drawn.clear()  # figures take memory, and the next effect has its own
    if not parts:
        return []
    gc.collect()  # the last effect's figures, which refer to themselves
    text = (
        "From the recordings that were learned from. Points: partial residual, that is the residual of the whole fit "
        "and the effect’s own share of it. Lines: the share that is fitted."
    )
    if not channel.judgement.helped:
        text += " These effects did not hold on the hold-out, and are not in the calibration."
    return [section("Evidence", element("p", text, class_="quiet"), *parts)]


def _left(channel: ChannelDiagnosis) -> list[Html]:
    if channel.verdict is Verdict.EXPLAINED:
        return []
    state = channel.findings.state if channel.judgement.helped else channel.findings.before
    drawn = [*left_charts(state, channel.name), *spectrum(channel.findings)]
    return [section("What is left in the recordings", charts(drawn))]


def _doubts(channel: ChannelDiagnosis) -> Html:
    parts = []
    alike, confirm = doubts.look_alikes(channel), doubts.would_confirm(channel)
    if alike:
        parts += [element("h4", "Explanations that the data cannot tell apart"), bullets(alike)]
    elif channel.findings.found and channel.judgement.helped and channel.findings.spectra is None:
        parts.append(element("p", "No other kind of effect in the catalogue comes close to what was found."))
    if confirm:
        parts += [element("h4", "What shows these effects best"), bullets(confirm)]
    parts += [element("h4", "What these recordings cannot show"), bullets(doubts.not_tried(channel), class_="two")]
    return section("How sure this is", *parts)


def _calibration(diagnosis: Diagnosis, channel: ChannelDiagnosis, original: Calibration | None) -> Html:
    if channel.after is channel.before:
        return section("The calibration", element("p", "This channel was left as it was."))
    new = next(c for c in diagnosis.calibration.channels if c.name == channel.name)
    text = (
        "Drift model and effects were fitted again together. On the recordings they leave "
        f"{quantity(new.error.fit, channel.name)} RMS."
    )
    return section(
        "What the augmented calibration changes",
        element("p", text),
        tables.calibrated_effects(diagnosis.calibration, channel.name),
        charts(drift_charts(original, diagnosis.calibration, channel.name)),
    )
