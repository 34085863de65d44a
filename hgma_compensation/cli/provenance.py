"""Where a calibration comes from, in sentences: its training, and the diagnosis that has added to it."""

from collections.abc import Iterator

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.quantities import count, duration


def trained(calibration: Calibration) -> Iterator[str]:
    """Yield how and on what it was trained."""
    training = calibration.training
    recordings = ", ".join(
        f"{one['name']} ({duration(one['duration'])}, {count(one['samples'])} samples)"
        for one in training["recordings"]
    )
    yield f"Trained by {training['method']}, seed {training['seed']}, on {recordings}"
    validation = f"; validated on {training['folds']}" if "folds" in training else ""
    yield f"Reference {training['reference']}; fitted to means of {duration(training['block'])}{validation}"


def diagnosed(calibration: Calibration) -> Iterator[str]:
    """Yield whether it was diagnosed, on what, and what that has added.

    The schema leaves this part of the file open, so that it may be of any form.
    """
    note = calibration.training.get("diagnosis")
    if not isinstance(note, dict):
        if calibration.effects:
            yield f"Effects beside the drift model: {_effects(calibration)}; not known from which diagnosis"
        else:
            yield "Not diagnosed yet: hgma diagnose names what it leaves"
        return
    recordings = note.get("recordings")
    names = (
        [str(name) for name in recordings] if isinstance(recordings, list) and recordings else ["unknown recordings"]
    )
    holdout = str(note.get("holdout", "an unknown recording"))
    judged = f"the end of {holdout}" if names == [holdout] else holdout
    learned = ", ".join(name for name in names if name != holdout) or names[0]
    yield f"Diagnosed on {learned}, judged on {judged}, seed {note.get('seed', 'unknown')}: {_added(calibration)}"


def _added(calibration: Calibration) -> str:
    return f"added {_effects(calibration)}" if calibration.effects else "no effect was added"


def _effects(calibration: Calibration) -> str:
    return ", ".join(f"{applied.effect.name} on {applied.channel}" for applied in calibration.effects)
