"""What lies in a folder, in a line for each kind, and what is wrong with it."""

from collections.abc import Sequence

from hgma_compensation.cli.folder import SUMMARY_PAGE, Here, RecordingHere
from hgma_compensation.cli.recording_topics import complaint
from hgma_compensation.quantities import duration

MOST_NAMED = 3
"""Names of a kind that a line lists."""


def found(here: Here) -> list[str]:
    """Return what to print of what is here."""
    kinds = (
        ("recording", [f"{one.path}{_lasting(one)}" for one in here.recordings]),
        ("calibration", [str(one.path) for one in here.calibrations]),
        ("diagnosis", [str(path / "report.html") for path in here.diagnoses]),
        ("table", [str(one.path) for one in here.tables]),
        ("fleet", [str(path) for path in here.fleets]),
        ("fleet's summary", [str(path / SUMMARY_PAGE) for path in here.fleet_results]),
        ("scenario", [str(path) for path in here.scenarios]),
    )
    said = [f"{_plural(kind, len(names))}: {_list(names)}" for kind, names in kinds if names]
    said += [f"{one.path} {reason}" for one in here.recordings if (reason := complaint(one))][:MOST_NAMED]
    return said or ["Here are no recording, no calibration and no table."]


def _plural(kind: str, number: int) -> str:
    many = {"diagnosis": "diagnoses", "fleet's summary": "fleets' summaries"}.get(kind, f"{kind}s")
    return kind.capitalize() if number == 1 else f"{number} {many}"


def _list(names: Sequence[str]) -> str:
    more = len(names) - MOST_NAMED
    return ", ".join(names[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _lasting(one: RecordingHere) -> str:
    return "" if one.duration is None else f" ({duration(one.duration)})"
