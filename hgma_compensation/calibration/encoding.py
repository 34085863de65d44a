"""A calibration as a plain JSON document, and back."""

from typing import Any, cast

import numpy as np

from hgma_compensation.calibration.bounds import LARGEST_DRIFT, largest_drift
from hgma_compensation.calibration.calibration import Calibration, ChannelCalibration, ChannelError
from hgma_compensation.calibration.effect_encoding import check_effects, decode_effect, encode_effect
from hgma_compensation.channels import unit_of
from hgma_compensation.drift.inputs import Array, InputScaling
from hgma_compensation.drift.model import CalibratedRange, DriftModel
from hgma_compensation.drift.polynomial import PolynomialDrift
from hgma_compensation.drift.radial_basis import RadialBasisDrift
from hgma_compensation.errors import RefusedError
from hgma_compensation.kalman.random_walk import RandomWalkNoise
from hgma_compensation.kalman.settings import FilterMode, FilterSettings
from hgma_compensation.temperature.features import NAMES, FeatureSettings, Product
from hgma_compensation.temperature.trend_filter import TrendNoise

Document = dict[str, Any]
FORMAT, VERSION = "hgma_calibration", 1


def encode(calibration: Calibration) -> Document:
    """Return the document of a calibration, without its id."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "sensor_id": calibration.sensor_id,
        "features": _encode_features(calibration.features),
        "calibrated_range": {
            name: [float(low), float(high)]
            for name, low, high in zip(
                NAMES, calibration.calibrated_range.lower, calibration.calibrated_range.upper, strict=True
            )
        },
        "channels": [_encode_channel(channel) for channel in calibration.channels],
        "effects": [encode_effect(applied) for applied in calibration.effects],
        "training": calibration.training,
    }


def decode(document: Document) -> Calibration:
    """Return the calibration of a document that follows the schema.

    Raises RefusedError for what a schema cannot express: shapes that do not fit each other, a channel
    given twice, a range that is empty, an effect that is none, an overflow when the model is evaluated.
    """
    calibration = Calibration(
        sensor_id=document["sensor_id"],
        features=_decode_features(document["features"]),
        calibrated_range=_decode_range(document["calibrated_range"]),
        channels=tuple(_decode_channel(c, f"channels[{i}]") for i, c in enumerate(document["channels"])),
        training=document["training"],
        calibration_id=document["calibration_id"],
        effects=tuple(decode_effect(e, f"effects[{i}]") for i, e in enumerate(document["effects"])),
    )
    if len(set(calibration.names)) < len(calibration.names):
        raise RefusedError("channels names the same channel twice: keep one of them")
    _check_drifts(calibration)
    check_effects(calibration)
    return calibration


def _encode_features(settings: FeatureSettings) -> Document:
    return {
        "process_noise": settings.noise.process,
        "measurement_noise": settings.noise.measurement,
        "product": settings.product.value,
        "delay": settings.delay,
        "reference_temperature": settings.reference_temperature,
        "latency": settings.latency,
        "prediction_horizon": settings.prediction_horizon,
    }


def _decode_features(document: Document) -> FeatureSettings:
    return FeatureSettings(
        noise=TrendNoise(float(document["process_noise"]), float(document["measurement_noise"])),
        product=Product(document["product"]),
        delay=float(document["delay"]),
        reference_temperature=float(document["reference_temperature"]),
        latency=float(document["latency"]),
        prediction_horizon=float(document["prediction_horizon"]),
    )


def _decode_range(document: Document) -> CalibratedRange:
    for name in NAMES:
        if not document[name][0] < document[name][1]:
            raise RefusedError(f"calibrated_range.{name} is empty: its first number must be below its second")
    limits = _array([document[name] for name in NAMES])
    return CalibratedRange(limits[:, 0].copy(), limits[:, 1].copy())


def _encode_channel(channel: ChannelCalibration) -> Document:
    return {
        "name": channel.name,
        "unit": unit_of(channel.name),
        "reference": channel.reference,
        "drift": _encode_drift(channel.drift),
        "filter": _encode_filter(channel.filter),
        "error": {
            "fit": channel.error.fit,
            "cross_validated": channel.error.cross_validated,
            "noise": channel.error.noise,
        },
    }


def _decode_channel(document: Document, path: str) -> ChannelCalibration:
    if document["unit"] != unit_of(document["name"]):
        raise RefusedError(f"{path}.unit is {document['unit']!r}, must be {unit_of(document['name'])!r}")
    return ChannelCalibration(
        name=document["name"],
        drift=_decode_drift(document["drift"], f"{path}.drift"),
        reference=float(document["reference"]),
        filter=_decode_filter(document["filter"]),
        error=_decode_error(document["error"]),
    )


def _decode_error(document: Document) -> ChannelError:
    validated = document["cross_validated"]
    return ChannelError(
        float(document["fit"]), float(document["noise"]), None if validated is None else float(validated)
    )


def _encode_drift(drift: DriftModel) -> Document:
    if isinstance(drift, RadialBasisDrift):
        return {
            "method": "rbf",
            "offset": drift.scaling.offset.tolist(),
            "scale": drift.scaling.scale.tolist(),
            "centres": drift.centres.tolist(),
            "widths": drift.widths.tolist(),
            "weights": drift.weights.tolist(),
            "bias": drift.bias,
            "linear": drift.linear.tolist(),
        }
    polynomial = cast(PolynomialDrift, drift)
    return {
        "method": "polynomial",
        "offset": polynomial.scaling.offset.tolist(),
        "scale": polynomial.scaling.scale.tolist(),
        "exponents": polynomial.exponents.tolist(),
        "coefficients": polynomial.coefficients.tolist(),
    }


def _decode_drift(document: Document, path: str) -> DriftModel:
    scaling = InputScaling(_array(document["offset"]), _array(document["scale"]))
    if document["method"] == "rbf":
        _same_length(document, path, "centres", "widths", "weights")
        return RadialBasisDrift(
            scaling,
            centres=_array(document["centres"]),
            widths=_array(document["widths"]),
            weights=_array(document["weights"]),
            bias=float(document["bias"]),
            linear=_array(document["linear"]),
        )
    _same_length(document, path, "exponents", "coefficients")
    return PolynomialDrift(scaling, np.array(document["exponents"], dtype=np.int64), _array(document["coefficients"]))


def _same_length(document: Document, path: str, *names: str) -> None:
    lengths = {name: len(document[name]) for name in names}
    if len(set(lengths.values())) > 1:
        sizes = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise RefusedError(f"{path} has shapes that do not fit: {sizes} rows; all must be equal")


def _encode_filter(settings: FilterSettings) -> Document:
    if settings.noise is None:
        return {"mode": settings.mode.value}
    document = {
        "mode": settings.mode.value,
        "white_noise": settings.noise.white,
        "random_walk": settings.noise.walk,
        "gate_threshold": settings.threshold,
        "wander": settings.wander,
    }
    if settings.mode is FilterMode.BIAS:
        document["initial_bias"] = settings.initial_bias
    return document


def _decode_filter(document: Document) -> FilterSettings:
    mode = FilterMode(document["mode"])
    if mode is FilterMode.OFF:
        return FilterSettings()
    noise = RandomWalkNoise(float(document["white_noise"]), float(document["random_walk"]))
    return FilterSettings(
        mode,
        noise,
        threshold=float(document["gate_threshold"]),
        wander=float(document["wander"]),
        initial_bias=float(document.get("initial_bias", 0.0)),
    )


def _array(numbers: list[Any]) -> Array:
    return np.array(numbers, dtype=np.float64)


def _check_drifts(calibration: Calibration) -> None:
    """Raise RefusedError where a drift model, anywhere in the range, could exceed what arithmetic carries."""
    for index, channel in enumerate(calibration.channels):
        with np.errstate(all="ignore"):
            largest = largest_drift(channel.drift, calibration.calibrated_range)
        if not largest <= LARGEST_DRIFT:
            raise RefusedError(
                f"channels[{index}].drift overflows inside the calibrated range: its numbers are damaged"
            )
