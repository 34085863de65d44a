"""Motion and effects of a scenario's document, as objects."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hgma_compensation.errors import RefusedError
from hgma_compensation.recording.csv_table import STANDARD_GRAVITY
from hgma_compensation.simulation.description import AppliedEffect
from hgma_compensation.simulation.effects import EFFECTS
from hgma_compensation.simulation.motion_description import Motion, Orientation, Shock, Vibration, Waveform
from hgma_compensation.simulation.waveform import MOST_ROWS, read_waveform

Document = Mapping[str, Any]


def decode_motion(document: Document, folder: Path) -> Motion:
    """Return the motion; files are taken relative to the scenario's folder."""
    return Motion(
        orientations=tuple(_orientation(entry) for entry in document.get("orientations", ())),
        shocks=tuple(
            Shock(entry["time"], entry["axis"], entry["peak_g"] * STANDARD_GRAVITY, entry["width"])
            for entry in document.get("shocks", ())
        ),
        vibrations=tuple(_vibration(entry, i) for i, entry in enumerate(document.get("vibrations", ()))),
        waveforms=_waveforms(document.get("waveforms", []), folder),
    )


def _orientation(entry: Document) -> Orientation:
    x, y, z = (STANDARD_GRAVITY * component for component in entry["specific_force_g"])
    return Orientation(entry["time"], (x, y, z), entry.get("turn", 1.0))


def _vibration(entry: Document, index: int) -> Vibration:
    low, high = entry["band"]
    if not 0.0 < low <= high:
        raise RefusedError(
            f"motion.vibrations[{index}].band must rise from above 0 Hz; twice the same number is a tone"
        )
    return Vibration(entry["start"], entry["end"], entry["axis"], entry["rms_g"] * STANDARD_GRAVITY, low, high)


def _waveforms(entries: list[Document], folder: Path) -> tuple[Waveform, ...]:
    made, rows = [], 0
    for index, entry in enumerate(entries):
        made.append(_waveform(entry, folder))
        rows += len(made[-1].times)
        if rows > MOST_ROWS:
            raise RefusedError(
                f"motion.waveforms[{index}]: the files have more than {MOST_ROWS} rows together: cut them"
            )
    return tuple(made)


def _waveform(entry: Document, folder: Path) -> Waveform:
    times, values = read_waveform(
        folder / entry["file"], entry["time_column"], entry["column"], entry["time_unit"], entry["unit"]
    )
    times = entry["time"] + entry.get("stretch", 1.0) * times
    return Waveform(entry["axis"], times, entry.get("scale", 1.0) * values)


def decode_effects(entries: list[Document], present: tuple[str, ...], document: Document) -> tuple[AppliedEffect, ...]:
    """Return the effects; raises RefusedError for one that the rest of the scenario leaves nothing to act on."""
    return tuple(_effect(dict(entry), index, present, document) for index, entry in enumerate(entries))


def _effect(entry: dict[str, Any], index: int, present: tuple[str, ...], document: Document) -> AppliedEffect:
    name, declared = entry.pop("effect"), entry.pop("declare", False)
    axes = tuple(entry.pop("axes", present))
    for axis in axes:
        if axis not in present:
            raise RefusedError(f"effects[{index}].axes names {axis!r}, which accelerometer.axes lacks")
    effect = EFFECTS[name](**entry)
    if effect.needs is not None and effect.needs not in document:
        raise RefusedError(f"effects[{index}] ({name}) needs the section {effect.needs!r}: add it")
    return AppliedEffect(name, effect, axes, declared)
