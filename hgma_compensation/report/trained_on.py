"""Whether a recording is one that a calibration was trained on, as far as their stamps and names tell."""

from dataclasses import dataclass
from typing import Any

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.quantities import counted
from hgma_compensation.report.words import listed


@dataclass(frozen=True)
class TrainedOn:
    """certain: it was. said: what to tell."""

    certain: bool
    said: str


def trained_on(calibration: Calibration, name: str, start: int, end: int) -> TrainedOn:
    """Return what is known of a recording with samples from ``start`` to ``end``, ns."""
    known = [one for one in calibration.training.get("recordings", ()) if isinstance(one, dict)]
    overlapping = [one for one in known if _overlaps(one, start, end)]
    named = [one for one in overlapping if one.get("name") == name]
    diagnosed = calibration.training.get("diagnosis")
    if named:
        return TrainedOn(
            True,
            "The calibration was trained on this recording: these errors are those of the fit, not of data it has not "
            "seen. Judge it on a recording of another day.",
        )
    if isinstance(diagnosed, dict) and name in diagnosed.get("recordings", ()):
        return TrainedOn(
            True,
            "The effects of the calibration were found in a recording of this name: if it is the same, these errors "
            "are those of the fit. Judge it on a recording of another day.",
        )
    if overlapping:
        names = listed([f"“{one.get('name')}”" for one in overlapping])
        return TrainedOn(
            False,
            f"Its stamps overlap with those of {names}, which the calibration was trained on. If it is a copy or a "
            "part of it, these errors are those of the fit; stamps of tables and simulations may coincide by chance.",
        )
    if not known:
        return TrainedOn(False, "The calibration does not say what it was trained on.")
    seen = "the recording" if len(known) == 1 else f"none of the {counted(len(known), 'recording')}"
    verb = "does not overlap" if len(known) == 1 else "overlaps"
    return TrainedOn(
        False,
        f"{seen.capitalize()} that the calibration was trained on {verb} in time with this one: nothing was fitted to "
        "it, and these errors are those of data not seen.",
    )


def _overlaps(one: dict[str, Any], start: int, end: int) -> bool:
    first = int(one.get("start", 0))
    return start <= first + round(1e9 * float(one.get("duration", 0.0))) and first <= end
