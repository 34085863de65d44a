"""The verdict in plain words."""

from hgma_compensation.diagnosis.result import ChannelDiagnosis
from hgma_compensation.diagnosis.verdict import Verdict
from hgma_compensation.report.words import found_parameters, listed, number, quantity

BADGES = {
    Verdict.EXPLAINED: "explained",
    Verdict.NO_EFFECT: "only noise",
    Verdict.UNEXPLAINED: "not explained",
}

COUNTS = {2: "two", 3: "three", 4: "four"}

NOTABLY_ABOVE = 1.5
"""Times the noise floor from which on the error that is left is worth a sentence."""


def effects_in_words(channel: ChannelDiagnosis) -> str:
    """Return the titles of the effects found, with the parameters that were looked for."""
    parts = []
    for found in channel.findings.found:
        parameters = found_parameters(found.effect)
        parts.append(found.effect.title + (f" ({', '.join(parameters)})" if parameters else ""))
    return listed(parts)


def headline(channel: ChannelDiagnosis) -> str:
    """Return the verdict in one sentence."""
    several = len(channel.findings.found) > 1
    if channel.verdict is Verdict.EXPLAINED:
        lacks = f"{COUNTS.get(len(channel.findings.found), 'several')} effects" if several else "one effect"
        return f"The calibration lacks {lacks}: {effects_in_words(channel)}."
    if channel.verdict is Verdict.NO_EFFECT:
        return "What is left is noise: the calibration lacks no effect that these recordings could show."
    if channel.partial:
        return (
            f"The residual is only partly explained: {effects_in_words(channel)} "
            f"{'carry' if several else 'carries'} some of it, and structure is left that nothing in the catalogue fits."
        )
    return "There is structure in the residual, and nothing in the catalogue fits it."


def figures(channel: ChannelDiagnosis) -> str:
    """Return the errors on the hold-out in one sentence."""
    before, after, floor = (
        quantity(value, channel.name) for value in (channel.error_before, channel.error_after, channel.noise_floor)
    )
    if channel.after is channel.before:
        return (
            f"The error on the hold-out is {before} RMS, {times_floor(channel, before=True)} times the noise floor "
            f"of {floor}; the calibration of this channel was left as it is."
        )
    return (
        f"With {'them' if len(channel.findings.found) > 1 else 'it'} in the calibration the error on the hold-out "
        f"falls from {before} to {after} RMS; the noise floor is {floor}."
    )


def qualification(channel: ChannelDiagnosis) -> str:
    """Return what must be said beside the verdict, "" where that is nothing."""
    reason = channel.judgement.reason
    if channel.verdict is Verdict.EXPLAINED and channel.findings.spectra is not None:
        return (
            "The recordings hold fewer than two temperature cycles: the memories fitted carry the loop together, but "
            "which of them is real they cannot say. Two cycles or more, at different rates, would."
        )
    if channel.verdict is Verdict.EXPLAINED:
        if channel.error_after > NOTABLY_ABOVE * channel.noise_floor:
            return (
                f"{times_floor(channel)} times the noise floor is left. It is what the fitted law, the causal estimate "
                "of the temperature and the slow part of the noise leave; the pictures show where."
            )
        return ""
    if channel.verdict is Verdict.UNEXPLAINED:
        return f"Why it is not called explained: {reason}."
    if channel.findings.found:
        return f"{effects_in_words(channel)}: {reason}.".capitalize()
    return ""


def times_floor(channel: ChannelDiagnosis, *, before: bool = False) -> str:
    """Return the error after, or before, over the noise floor."""
    error = channel.error_before if before else channel.error_after
    return number(error / channel.noise_floor, 2) if channel.noise_floor > 0.0 else "–"
