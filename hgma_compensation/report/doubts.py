"""What the data cannot tell apart, what could not be tried, and which experiment would settle it."""

from hgma_compensation.channels import group_of
from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.diagnosis.verdict import Verdict
from hgma_compensation.effects.effect import Effect, Need
from hgma_compensation.effects.registry import kinds
from hgma_compensation.report.words import listed, number, title_of

NEEDED = {
    Need.TEMPERATURE_2: "no second thermometer in all recordings (topic accel/temperature_2)",
    Need.SUPPLY_VOLTAGE: "no supply voltage in the recordings (topic accel/supply_voltage)",
    Need.OTHER_AXIS: "no other axis of the acceleration in all recordings",
}


SCARCE = "not compared, since fewer than two temperature cycles were learned from"


def look_alikes(channel: ChannelDiagnosis) -> list[str]:
    """Return a sentence for each explanation that fits as well as one that was found, with the way out."""
    said = []
    for found in channel.findings.found:
        for name, difference in sorted(found.runners_up.items(), key=lambda item: item[1]):
            experiments = [found.effect.identified_by, kinds()[name].identified_by if name in kinds() else ""]
            wanted = "; and ".join(dict.fromkeys(text for text in experiments if text))
            than = "worse" if difference >= 0.0 else "better"
            said.append(
                f"“{title_of(name)}” fits nearly as well as “{found.effect.title}” (BIC {number(abs(difference), 2)} "
                f"{than}): these recordings cannot tell them apart. What would: {wanted}."
            )
    return said + [_follows(kinds()[name]) for name in channel.undecided]


def _follows(kind: type[Effect]) -> str:
    alike = listed([f"“{title_of(name)}”" for name in kind.confused_with])
    return (
        f"“{kind.title}” would fit as well, but what it answers to moved only as the temperature and its rate make it: "
        f"these recordings cannot tell it from {alike}, or from what the drift does with the rate. What would: "
        f"{kind.identified_by}."
    )


def would_confirm(channel: ChannelDiagnosis) -> list[str]:
    """Return for each effect found what must vary in a recording that shows it best."""
    return [
        f"{found.effect.title}: {found.effect.identified_by}."
        for found in channel.findings.found
        if found.effect.identified_by
    ]


def not_tried(channel: ChannelDiagnosis) -> list[str]:
    """Return the kinds of effects that these recordings cannot show, and why; humidity is never recorded."""
    tried = {c.scored.name for stage in channel.findings.stages for c in stage}
    tried |= {found.effect.name for found in channel.findings.found}
    missing = {kind: _missing(channel, kind) for name, kind in kinds().items() if name not in tried}
    said = [f"{kind.title}: {why}. It takes {kind.identified_by}." for kind, why in missing.items() if why != SCARCE]
    scarce = [kind.title for kind, why in missing.items() if why == SCARCE]
    if scarce:
        said.append(f"{listed(scarce)}: {SCARCE}.")
    return [*said, "humidity: it is never recorded, and looks like a slow warm-up; keep the sensor dry or log it."]


def _missing(channel: ChannelDiagnosis, kind: type[Effect]) -> str:
    survey = channel.findings.state.problem.survey
    here = {
        Need.TEMPERATURE_2: all(run.second is not None for run in channel.findings.state.problem.scene.runs),
        Need.SUPPLY_VOLTAGE: survey.voltage > 0.0,
        Need.OTHER_AXIS: any(group_of(other) == "linear_acceleration" for other in survey.others),
    }
    for need in kind.needs:
        if not here[need]:
            return NEEDED[need]
    if channel.findings.spectra is not None:
        return SCARCE
    if kind.input_driven and not survey.inputs:
        return "no real acceleration that recurs in the recordings"
    if kind.name == "vibration_rectification" and not survey.vibration:
        return "the noise of the channel never changes: nothing vibrates"
    if kind.name == "post_shock_zero_shift":
        return "no shock in the recordings"
    return "nothing in the recordings sets it off, or it was withheld"


def advice(channel: ChannelDiagnosis) -> str:
    """Return what to do next where the verdict leaves something open."""
    if channel.verdict is not Verdict.UNEXPLAINED:
        return ""
    return (
        "What to do: look at the pictures below for what it goes with, record what could drive it beside the "
        "accelerometer (second thermometer, supply voltage, humidity), repeat the same cycle to see whether it comes "
        "back, and diagnose again."
    )
