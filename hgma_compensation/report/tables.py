"""Tables of the report."""

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.diagnosis.result import ChannelDiagnosis, Diagnosis, reported_name
from hgma_compensation.quantities import shown_unit
from hgma_compensation.report.markup import Html, element, table
from hgma_compensation.report.sentences import BADGES, times_floor
from hgma_compensation.report.words import (
    all_parameters,
    duration,
    instant,
    number,
    plain_name,
    quantity,
)


def badge(channel: ChannelDiagnosis) -> Html:
    """Return the coloured word of a verdict."""
    return element("span", BADGES[channel.verdict], class_=f"badge {channel.verdict.value}")


def overview(diagnosis: Diagnosis) -> Html:
    """Return one line for each channel."""
    rows = [
        [
            element("a", channel.name, href=f"#channel-{index}"),
            badge(channel),
            ", ".join(plain_name(reported_name(found.effect)) for found in channel.findings.found)
            if channel.effects or channel.partial
            else "–",
            quantity(channel.error_before, channel.name),
            quantity(channel.error_after, channel.name),
            quantity(channel.noise_floor, channel.name),
            f"{times_floor(channel)} ×",
        ]
        for index, channel in enumerate(diagnosis.channels)
    ]
    heads = ("channel", "verdict", "effects", "error before", "error after", "noise floor", "after / floor")
    return table(heads, rows, numbers=(3, 4, 5, 6))


def calibrated_effects(calibration: Calibration, channel: str) -> Html:
    """Return the effects of the augmented calibration with parameters and gains."""
    rows = []
    for applied in calibration.effects:
        if applied.channel == channel:
            gains = applied.gains.tolist()
            text = f"{len(gains)}: {', '.join(number(gain) for gain in gains)}"
            rows.append(
                [
                    applied.effect.title,
                    element("code", applied.effect.name),
                    ", ".join(all_parameters(applied.effect)) or "none",
                    f"{text} {shown_unit(unit_of(channel) + applied.effect.gain_unit)}",
                ]
            )
    if not rows:
        return element("p", f"No effect was added to {channel}.")
    return table(("effect", "name", "parameters", "gains"), rows)


def recordings(diagnosis: Diagnosis) -> Html:
    """Return what was learned from and what was held out."""
    material = diagnosis.material
    rows = []
    for recording in material.recordings:
        share = material.share_held(recording)
        if share == 0.0:
            role = "learned from"
        else:
            first = instant(material.held[0])
            role = "held out" if share == 1.0 else f"held out from {first} on ({round(100.0 * share)} % of it)"
        rate = (recording.samples - 1) / recording.duration if recording.duration > 0.0 else 0.0
        rows.append(
            [
                recording.name,
                instant(recording.start),
                duration(recording.duration),
                f"{recording.samples} ({number(rate)} Hz)",
                role,
            ]
        )
    return table(("recording", "begins", "lasts", "samples", "used as"), rows, numbers=(2, 3))


def noise(channel: ChannelDiagnosis) -> Html:
    """Return the noise model that a channel was judged by."""
    state = channel.findings.state
    model, problem = state.noise, state.problem
    white = float(sorted(model.white)[len(model.white) // 2]) ** 0.5
    carried = float(sorted(model.thermistor)[len(model.thermistor) // 2])
    rows = [
        ["length of a block mean", duration(problem.block)],
        ["block means learned from", str(len(problem.scene.blocks))],
        ["white noise of a block mean", quantity(white, channel.name)],
        ["flicker (deviation for each e-fold of time)", quantity(float(model.flicker) ** 0.5, channel.name)],
        ["error of the temperature of a block mean", f"{number(1e3 * problem.thermistor.deviation)} mK"],
        ["the same through the slope of the drift", quantity(carried, channel.name)],
    ]
    return table((f"noise model of {channel.name}", "value"), rows, numbers=(1,))
