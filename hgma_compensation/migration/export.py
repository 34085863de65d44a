"""A calibration as an autopilot's parameters, with what is lost."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from hgma_compensation.calibration.calibration import Calibration
from hgma_compensation.channels import unit_of
from hgma_compensation.drift.inputs import Array
from hgma_compensation.migration import ardupilot, px4
from hgma_compensation.migration.cautions import warnings_of
from hgma_compensation.migration.cubic import FittedCubic, Span, fit_cubics, span_of
from hgma_compensation.migration.not_carried import not_carried
from hgma_compensation.migration.parameters import Parameter, in_axes
from hgma_compensation.migration.recording_loss import Offsets, RecordingLoss
from hgma_compensation.migration.target import Format, Target
from hgma_compensation.stamps import Stamps


@dataclass(frozen=True)
class Export:
    """cubics: in the calibration's axes. rounding: by channel, what single precision does at the most, in its unit."""

    calibration: Calibration
    target: Target
    span: Span
    cubics: tuple[FittedCubic, ...]
    parameters: tuple[Parameter, ...]
    rounding: Mapping[str, float]
    not_carried: tuple[str, ...]
    warnings: tuple[str, ...]

    def offsets(self) -> Offsets:
        """Return what computes the offsets of all calibrated channels as the autopilot does, from its first samples on.

        For ArduPilot with the constant term, which its own accelerometer calibration takes up; 0 for a channel that is
        not exported.
        """
        held = px4.Held()
        cubics = {f.cubic.channel: f for f in self.cubics}
        names = self.calibration.names

        def offsets(stamps: Stamps, temperature: Array) -> Array:
            used = held.used(stamps, temperature) if self.target.is_px4 else temperature
            found = np.zeros((len(stamps), len(names)))
            for column, name in enumerate(names):
                if name in cubics:
                    found[:, column] = _offset(cubics[name], self.span, used, self.target.is_px4)
            return found

        return offsets

    def text(self) -> str:
        """Return the content of the file."""
        comments = (
            f"Cubics of calibration {self.calibration.calibration_id}, sensor {self.calibration.sensor_id}",
            *(
                f"{f.cubic.channel}: cubic less full model at rest RMS {f.at_rest.rms:.3g}, "
                f"worst {f.at_rest.worst:.3g}; over the calibrated rates RMS {f.over_rates.rms:.3g}, "
                f"worst {f.over_rates.worst:.3g} {unit_of(f.cubic.channel)}"
                for f in self.cubics
            ),
            *(f"Not carried: {line}" for line in self.not_carried),
        )
        if self.target.format is Format.PX4:
            return px4.ground_station_file(self.parameters, comments)
        if self.target.format is Format.PX4_SHELL:
            return px4.shell_script(self.parameters, comments)
        return ardupilot.parameter_file(self.parameters, comments)

    def as_json(self, recording: tuple[RecordingLoss, ...] = ()) -> dict[str, Any]:
        """Return the figures in the form that scripts rely on."""
        found: dict[str, Any] = {
            "calibration_id": self.calibration.calibration_id,
            "format": self.target.format.value,
            "axes": self.target.axes.value,
            "temperature_range": [self.span.lowest, self.span.highest],
            "reference_temperature": self.span.reference,
            "parameters": {p.name: int(p.text) if isinstance(p.value, int) else float(p.text) for p in self.parameters},
            "channels": {f.cubic.channel: self._channel(f) for f in self.cubics},
            "not_carried": list(self.not_carried),
            "warnings": list(self.warnings),
        }
        if recording:
            found["recording"] = {loss.channel: _without_name(loss) for loss in recording}
        return found

    def _channel(self, fitted: FittedCubic) -> dict[str, Any]:
        name = fitted.cubic.channel
        return {
            "unit": unit_of(name),
            "coefficients": fitted.cubic.coefficients.tolist(),
            "at_rest": asdict(fitted.at_rest),
            "over_rates": asdict(fitted.over_rates),
            "steepest": fitted.steepest,
            "rounding": self.rounding[name],
        }


def make_export(calibration: Calibration, target: Target) -> Export:
    """Return a calibration as the autopilot's parameters.

    Raises RefusedError for an instance that the autopilot does not have, an id that is none, and channels and
    temperatures that are not calibrated.
    """
    is_px4 = target.is_px4
    target.check()
    span = span_of(calibration, px4.REFERENCE if is_px4 else ardupilot.REFERENCE, target.span)
    wanted = target.wanted(calibration.names)
    fitted = tuple(f for f in fit_cubics(calibration, span) if f.cubic.channel in wanted)
    cubics = in_axes([f.cubic for f in fitted], target.axes)
    device_ids = target.device_ids or {}
    if is_px4:
        found = px4.parameters(cubics, span, target.instance, device_ids)
    else:
        found = ardupilot.parameters(cubics, span, target.instance)
    grid = span.grid()
    return Export(
        calibration=calibration,
        target=target,
        span=span,
        cubics=fitted,
        parameters=tuple(found),
        rounding={f.cubic.channel: _rounding(f, span, grid, is_px4) for f in fitted},
        not_carried=not_carried(calibration, wanted),
        warnings=warnings_of(calibration, fitted, span, target.instance, device_ids if is_px4 else None),
    )


def _offset(fitted: FittedCubic, span: Span, temperature: Array, is_px4: bool) -> Array:
    cubic = fitted.cubic
    if is_px4:
        return px4.offset(cubic, span, temperature).astype(np.float64)
    return ardupilot.polynomial(cubic, span, temperature).astype(np.float64) + cubic.coefficients[0]


def _rounding(fitted: FittedCubic, span: Span, grid: Array, is_px4: bool) -> float:
    return float(np.abs(_offset(fitted, span, grid, is_px4) - fitted.cubic.evaluate(grid)).max())


def _without_name(loss: RecordingLoss) -> dict[str, float]:
    figures = asdict(loss)
    del figures["channel"]
    return figures
