import json
import os

import pytest

from hgma_compensation.calibration.document import LARGEST_FILE, content_id, read_calibration
from hgma_compensation.errors import RefusedError


def refusal_of(path):
    """Return the text of the refusal after the path, having checked its form."""
    with pytest.raises(RefusedError) as caught:
        read_calibration(path)
    text = str(caught.value)
    assert len(text.splitlines()) == 1
    assert text.startswith(f"calibration {path}: ")
    return text.removeprefix(f"calibration {path}: ")


def rewrite(path, change, *, new_id=True):
    """Change the document in a file, and give it the id of its content."""
    document = json.loads(path.read_text())
    change(document)
    if new_id:
        document["calibration_id"] = content_id(document)
    path.write_text(json.dumps(document))


def test_truncated_file_is_refused_wherever_it_ends(calibration_file):
    whole = calibration_file.read_bytes()
    for length in range(0, len(whole.rstrip()), 10):
        calibration_file.write_bytes(whole[:length])
        assert refusal_of(calibration_file).endswith("it is truncated or damaged, copy it again")


def set_at(*keys, value):
    def change(document):
        for key in keys[:-1]:
            document = document[key]
        document[keys[-1]] = value(document[keys[-1]]) if callable(value) else value

    return change


EFFECT = {
    "effect": "stress_relaxation",
    "channel": "linear_acceleration.z",
    "parameters": {"time_constant": 900.0, "spread": 1.0},
    "gains": [0.1],
}

QUADRATIC = {
    "effect": "quadratic_nonlinearity",
    "channel": "linear_acceleration.z",
    "parameters": {"channel": "linear_acceleration.z"},
    "gains": [1e9],
}
GRADIENT = {"effect": "thermal_gradient", "channel": "linear_acceleration.z", "parameters": {}, "gains": [0.1, 0.1]}


def with_effect(**changes):
    """Put one effect into a document, with other fields or, by their names, other parameters."""

    def change(document):
        effect = {**EFFECT, **{name: value for name, value in changes.items() if name in EFFECT}}
        others = {name: value for name, value in changes.items() if name not in EFFECT}
        document["effects"] = [{**effect, "parameters": {**effect["parameters"], **others}}]

    return change


CHANGES = [
    (set_at("version", value=2), "version is 2, this program reads version 1: train again"),
    (set_at("version", value=True), "version is True, this program reads version 1: train again"),
    (set_at("format", value="px4"), "format: this is not a calibration .*: give a file written by hgma train"),
    (set_at("sensor_id", value=7), "sensor_id is 7, must be a string"),
    (
        set_at("channels", 0, "drift", "centres", value=lambda c: c[:-1]),
        "centres has 4, widths has 5, weights has 5",
    ),
    (
        set_at("channels", 0, "drift", "widths", value=lambda w: w[:-1]),
        "centres has 5, widths has 4, weights has 5",
    ),
    (set_at("channels", 2, "drift", "weights", value=[1.0]), r"channels\[2\].drift .*weights has 1 rows"),
    (
        set_at("channels", 0, "drift", "widths", 1, value=[1.0, 0.0, 1.0]),
        r"widths\[1\]\[1\] is 0.0, must be at least 1e-30",
    ),
    (set_at("channels", 0, "drift", "linear", value=[1.0]), "drift.linear has 1 elements, must have 3"),
    (set_at("channels", 0, "drift", "weights", value=[1e308] * 5), r"weights\[0\] is 1e\+308, must be at most 1"),
    (set_at("channels", 0, "drift", "weights", value=[9e11] * 5), r"channels\[0\].drift overflows inside"),
    (set_at("channels", 1, "name", value="linear_acceleration.x"), "channels names the same channel twice: keep one"),
    (set_at("channels", 1, "unit", value="rad/s"), r"channels\[1\].unit is 'rad/s', must be 'm/s\^2'"),
    (set_at("channels", value=[]), "channels has 0 elements, must have 1 to 6"),
    (
        set_at("calibrated_range", "temperature", value=[60.0, -10.0]),
        "calibrated_range.temperature is empty",
    ),
    (set_at("calibrated_range", "temperature_rate", value=[0.0, 0.0]), "calibrated_range.temperature_rate is empty"),
    (set_at("effects", value=[{"name": "thermal_lag"}]), r"effects\[0\] lacks the field 'effect'"),
    (with_effect(effect="magic"), r"effects\[0\]\.effect 'magic' is unknown, must be one of aging, .*warm_up"),
    (with_effect(channel="angular_velocity.x"), r"effects\[0\]\.channel is 'angular_velocity.x', must be calibrated"),
    (with_effect(channel="z"), r"effects\[0\]\.channel is 'z', must be one of"),
    (with_effect(parameters={}), r"effects\[0\]\.parameters lacks the field 'time_constant'"),
    (with_effect(time_constant=1.0), r"effects\[0\]\.parameters\.time_constant is 1\.0, must be \d+ to 200000 s"),
    (with_effect(time_constant="long"), r"effects\[0\]\.parameters\.time_constant is 'long', .* wrong type"),
    (with_effect(time_constant=[1.0]), r"effects\[0\]\.parameters\.time_constant is an array, must be a number or a"),
    (with_effect(delay=1.0), r"effects\[0\]\.parameters has the unknown field 'delay'"),
    (with_effect(gains=[1.0, 2.0]), r"effects\[0\]\.gains has 2 elements, must have 1 with these parameters"),
    (with_effect(gains=[1e308]), r"effects\[0\].gains\[0\] is 1e\+308, must be at most 1"),
    (lambda d: d.update(effects=[QUADRATIC] * 5), r"effects\[2\] overflows inside the calibrated range"),
    (
        lambda d: d.update(effects=[{**QUADRATIC, "gains": [6e-11]}] * 9 + [{**GRADIENT, "gains": [2e11, 0.0]}]),
        r"effects\[[0-8]\] overflows inside the calibrated range",
    ),
    (
        with_effect(effect="quadratic_nonlinearity", parameters={"channel": "linear_acceleration.x"}),
        r"effects\[0\]\.parameters\.channel is 'linear_acceleration.x', must be 'linear_acceleration.z'",
    ),
    (lambda document: document.update(effects=[EFFECT] * 65), "effects has 65 elements, must have 0 to 64"),
    (set_at("features", "delay", value=0), "features.delay is 0, must be above 0"),
    (set_at("features", "prediction_horizon", value=60.5), "features.prediction_horizon is 60.5, must be at most 60"),
    (lambda document: document.pop("training"), "the document lacks the field 'training'"),
    (lambda document: document.update(note="mine"), "the document has the unknown field 'note'"),
]


@pytest.mark.parametrize(("change", "reason"), CHANGES, ids=[reason[:60] for _, reason in CHANGES])
def test_file_with_wrong_content_is_refused_naming_field_and_remedy(calibration_file, change, reason):
    rewrite(calibration_file, change)
    with pytest.raises(RefusedError, match=reason):
        read_calibration(calibration_file)
    assert refusal_of(calibration_file).endswith(
        ("take it from its source again", "written by hgma train", "train again or use the matching release")
    )


@pytest.mark.parametrize("keys", [("sensor_id",), ("training", "method"), ("calibration_id",)])
def test_edited_file_with_its_old_id_is_refused(calibration_file, keys):
    rewrite(calibration_file, set_at(*keys, value="sha256-0123456789abcdef"), new_id=False)
    assert "the file was changed after it was written" in refusal_of(calibration_file)


@pytest.mark.parametrize(
    ("literal", "reason"),
    [
        ("NaN", "holds NaN, which is no number"),
        ("Infinity", "holds Infinity, which is no number"),
        ("-Infinity", "holds -Infinity, which is no number"),
        ("1e999", r"channels[0].drift.bias is not finite"),
        ("-1e999", r"channels[0].drift.bias is not finite"),
        ("1" + 400 * "0", "channels[0].drift.bias"),
        ("1" + 5000 * "0", "absurd number"),
    ],
)
def test_number_that_is_none_is_refused(calibration_file, literal, reason):
    rewrite(calibration_file, set_at("channels", 0, "drift", "bias", value=0.5))
    calibration_file.write_text(calibration_file.read_text().replace('"bias": 0.5', f'"bias": {literal}'))
    assert reason in refusal_of(calibration_file)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is not complete JSON"),
        (b"\xff\xfe{\x00}\x00", "is not UTF-8 text"),
        (b"[1, 2]", "format: this is not a calibration"),
        (b'"hgma_calibration"', "format: this is not a calibration"),
        (b"{}", "format: this is not a calibration"),
        (b'{"format": "hgma_calibration"}', "version is None, this program reads version 1"),
        (b'{"format": "hgma_calibration", "format": "hgma_calibration"}', "format is given twice"),
        (b"[" * 100_000, "nested too deeply"),
        (b"[" + b"1," * 100_000 + b"1]", "far more elements than a calibration"),
        (b'{"a":' * 100_000, "nested too deeply"),
        (b"\x00" * 100, "is not complete JSON"),
    ],
)
def test_file_that_is_something_else_is_refused(tmp_path, content, reason):
    (tmp_path / "other.json").write_bytes(content)
    assert reason in refusal_of(tmp_path / "other.json")


def test_duplicate_key_deep_inside_is_refused(calibration_file):
    calibration_file.write_text(calibration_file.read_text().replace('"bias":', '"bias": 1.0, "bias":', 1))
    assert refusal_of(calibration_file) == "bias is given twice: the file was edited, take it from its source again"


def test_nesting_of_any_depth_is_read_or_refused(calibration_file):
    text = calibration_file.read_text()
    for depth in [100, *range(800, 1001)]:  # past the default limit of recursion
        nested = f'"more": {"[" * depth}{"]" * depth}'
        calibration_file.write_text(text.replace('"tool": "test"', f'"tool": "test", {nested}'))
        refusal = refusal_of(calibration_file)
        assert "nested too deeply" in refusal or "was changed after it was written" in refusal


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("pipe", "is not a regular file"),  # opening it must not wait for a writer
        (".", "is not a regular file"),
        ("large", f"has {LARGEST_FILE + 1} bytes"),
        ("missing", "cannot be opened (No such file or directory)"),
        ("large/inner", "cannot be opened (Not a directory)"),
        ("loop", "cannot be opened (Too many levels of symbolic links)"),
    ],
)
def test_what_is_no_file_is_refused_and_closed_again(tmp_path, name, reason):
    os.mkfifo(tmp_path / "pipe")
    with open(tmp_path / "large", "wb") as file:
        file.truncate(LARGEST_FILE + 1)
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    opened = os.listdir("/proc/self/fd")
    assert reason in refusal_of(tmp_path / name)
    assert os.listdir("/proc/self/fd") == opened
