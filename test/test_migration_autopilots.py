"""Exported parameters, computed with as the autopilots do it."""

import re

import numpy as np
import pytest
from autopilots import ardupilot_correction, commas, ground_station, px4_offset, shell
from builders import make_calibration
from hypothesis import given, settings
from hypothesis import strategies as st

from hgma_compensation.channels import AXES, CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.migration import ardupilot, px4
from hgma_compensation.migration.cubic import Cubic, Span
from hgma_compensation.migration.export import make_export
from hgma_compensation.migration.parameters import AxisConvention, Parameter
from hgma_compensation.migration.target import Format, Target
from hgma_compensation.stamps import NANOSECONDS

EPSILON, SMALLEST = 2.0**-23, 2.0**-126
ALL = make_calibration(2, channels=CHANNELS)
ACCELEROMETER = make_calibration(2)
TEMPERATURES = [-60.0, -11.0, -3.25, 25.0, 35.0, 44.5, 61.0, 90.0]


@st.composite
def cubics(draw, reference=None):
    """A cubic whose terms are each up to some size at the ends of a span, and the span."""
    lowest = draw(st.floats(-60.0, 40.0))
    highest = lowest + draw(st.floats(5.0, 120.0))
    about = 0.5 * (lowest + highest) if reference is None else reference
    reach = max(highest - about, about - lowest)
    size = 10.0 ** draw(st.floats(-4.0, 4.0))
    terms = np.array([draw(st.floats(-1.0, 1.0)) for _ in range(4)])
    return Cubic("linear_acceleration.z", about, size * terms / reach ** np.arange(4)), Span(lowest, highest, about)


def bound(cubic, span):
    """Return what single precision may do: roundings of coefficients, products and sums, and of the temperature.

    Beside them what is too small for single precision, which vanishes.
    """
    reach = max(abs(span.lowest - span.reference), abs(span.highest - span.reference))
    terms = np.abs(cubic.coefficients) * reach ** np.arange(4)
    slope = np.sum(terms[1:] * np.arange(1, 4)) / reach
    hottest = max(abs(span.lowest), abs(span.highest), abs(span.reference))
    vanished = SMALLEST * np.sum(reach ** np.arange(4))
    return EPSILON * (8.0 * terms.sum() + 2.0 * slope * hottest) + vanished


@settings(deadline=None)
@given(cubics(), st.floats(0.0, 1.0))
def test_px4s_single_precision_gives_the_cubic(made, place):
    cubic, span = made
    temperature = span.lowest + place * (span.highest - span.lowest)
    text = px4.ground_station_file(px4.parameters({cubic.channel: cubic}, span, 1, {}), [])
    offset = px4_offset(ground_station(text)[0], "A", 1, temperature)
    assert offset[:2] == [0.0, 0.0]
    expected = cubic.evaluate(np.array([temperature]))[0]
    assert abs(float(offset[2]) - expected) <= bound(cubic, span)
    ours = px4.offset(cubic, span, np.array([temperature]))
    assert abs(float(ours[0]) - float(offset[2])) <= bound(cubic, span)


@settings(deadline=None)
@given(cubics(35.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_ardupilots_single_precision_gives_the_difference_of_the_cubic(made, now, then):
    cubic, span = made
    at, calibrated = (span.lowest + place * (span.highest - span.lowest) for place in (now, then))
    text = ardupilot.parameter_file(ardupilot.parameters({cubic.channel: cubic}, span, 2), [])
    correction = ardupilot_correction(commas(text), "ACC", 2, at, calibrated)
    expected = np.subtract(*cubic.evaluate(np.array([calibrated, at])))
    assert abs(float(correction[2]) - expected) <= 2.0 * bound(cubic, span)
    ours = np.subtract(*ardupilot.polynomial(cubic, span, np.array([calibrated, at])).astype(float))
    assert abs(ours - expected) <= 2.0 * bound(cubic, span)


@pytest.mark.parametrize("temperature", TEMPERATURES)
def test_every_channel_of_px4_is_the_autopilots_formula_to_the_bit(temperature):
    export = make_export(ALL, Target(Format.PX4, 3))
    values, _ = ground_station(export.text())
    offsets = export.offsets()(np.array([NANOSECONDS]), np.array([temperature]))[0]
    np.testing.assert_array_equal(offsets[:3], px4_offset(values, "A", 3, temperature))
    np.testing.assert_array_equal(offsets[3:], px4_offset(values, "G", 3, temperature))
    assert shell(make_export(ALL, Target(Format.PX4_SHELL, 3)).text()) == values


@pytest.mark.parametrize("temperature", TEMPERATURES)
def test_every_channel_of_ardupilot_is_the_autopilots_formula(temperature):
    export = make_export(ALL, Target(Format.ARDUPILOT, 0))
    values = commas(export.text())
    at = np.array([temperature, 20.0])
    offsets = export.offsets()(np.array([1, 2]) * NANOSECONDS, at)
    for group, columns in (("ACC", slice(0, 3)), ("GYR", slice(3, 6))):
        correction = ardupilot_correction(values, group, 0, temperature, 20.0)
        np.testing.assert_allclose(np.subtract(*offsets[::-1, columns]), correction, rtol=1e-5, atol=1e-5)


def test_names_and_types_are_those_of_px4():
    # PX4/PX4-Autopilot src/modules/temperature_compensation/module.yaml
    export = make_export(ALL, Target(Format.PX4, 2, device_ids={"linear_acceleration": 5, "angular_velocity": 7}))
    values, types = ground_station(export.text())
    expected = {"TC_A_ENABLE", "TC_G_ENABLE"}
    for letter in "AG":
        expected |= {f"TC_{letter}2_{name}" for name in ("ID", "TREF", "TMIN", "TMAX")}
        expected |= {f"TC_{letter}2_X{power}_{axis}" for power in range(4) for axis in range(3)}
    assert set(values) == expected
    integers = {name for name, kind in types.items() if kind == 6}
    assert integers == {name for name in values if name.endswith(("ENABLE", "ID"))}
    assert {types[name] for name in set(types) - integers} == {9}
    assert (values["TC_A2_ID"], values["TC_G2_ID"], values["TC_A_ENABLE"]) == ("5", "7", "1")
    assert next(iter(values)) == "TC_A_ENABLE"  # PX4 knows the rest only once it is enabled


def test_names_are_those_of_ardupilot():
    # ArduPilot/ardupilot libraries/AP_InertialSensor/AP_InertialSensor_tempcal.cpp, get_persistent_params
    values = commas(make_export(ALL, Target(Format.ARDUPILOT, 1)).text())
    expected = {f"INS_TCAL2_{name}" for name in ("ENABLE", "TMIN", "TMAX")}
    expected |= {f"INS_TCAL2_{kind}{power}_{axis}" for kind in ("ACC", "GYR") for power in (1, 2, 3) for axis in "XYZ"}
    assert set(values) == expected
    assert values["INS_TCAL2_ENABLE"] == "1"


def test_only_groups_with_a_calibrated_channel_are_written():
    gyro = make_calibration(channels=["angular_velocity.y"])
    values, _ = ground_station(make_export(gyro, Target(Format.PX4)).text())
    assert not [name for name in values if name.startswith("TC_A")]
    assert float(values["TC_G0_X1_0"]) == 0.0 != float(values["TC_G0_X1_1"])
    assert not [name for name in commas(make_export(gyro, Target(Format.ARDUPILOT)).text()) if "_ACC" in name]


def test_ros_axes_turn_the_offsets_about_x():
    same, flu = (ground_station(make_export(ALL, Target(Format.PX4, axes=axes)).text())[0] for axes in AxisConvention)
    for letter in "AG":
        for number, sign in enumerate((1.0, -1.0, -1.0)):
            for power in range(4):
                name = f"TC_{letter}0_X{power}_{number}"
                assert float(flu[name]) == sign * float(same[name])


def test_an_id_of_more_than_31_bits_is_the_signed_number_that_px4_compares():
    values, _ = ground_station(
        make_export(ALL, Target(Format.PX4, device_ids={"linear_acceleration": 2**32 - 3})).text()
    )
    assert values["TC_A0_ID"] == "-3"


@settings(deadline=None)
@given(st.floats(-1e18, 1e18))
def test_a_value_is_read_back_to_the_bit_and_has_no_exponent(value):
    text = Parameter("NAME", value).text
    assert re.fullmatch(r"-?\d+\.\d+", text)
    assert np.float32(text) == np.float32(value)


def held_one_by_one(stamps, temperature):
    """Return the temperature in use for each sample, as PX4's module that runs once a second keeps it."""
    last, used, due, found = np.float32(-100.0), 0.0, None, []
    for stamp, value in zip(stamps.tolist(), temperature.tolist(), strict=True):
        if due is None or not due - NANOSECONDS <= stamp < due:
            due = stamp + NANOSECONDS
            if abs(np.float32(value) - last) > 1.0:
                last, used = np.float32(value), value
        found.append(used)
    return found


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.lists(st.integers(0, 300), max_size=4))
def test_offsets_are_held_as_px4_does_however_the_samples_are_split(seed, cuts):
    random = np.random.default_rng(seed)
    steps = random.choice([10_000_000, 333_000_000, 1_000_000_000, 5_000_000_000], 300)
    if seed % 3 == 0:
        steps[150] = -20 * NANOSECONDS  # a bag that loops
    stamps = 10**15 + np.cumsum(steps)
    temperature = 20.0 + np.cumsum(random.normal(0.0, 0.4, 300))
    held, parts = px4.Held(), []
    for part in np.split(np.arange(300), sorted(cuts)):
        parts.append(held.used(stamps[part], temperature[part]))
    assert np.concatenate(parts).tolist() == held_one_by_one(stamps, temperature)


def test_the_figures_name_what_single_precision_does():
    for format_ in (Format.PX4, Format.ARDUPILOT):
        export = make_export(ALL, Target(format_))
        for fitted in export.cubics:
            assert 0.0 < export.rounding[fitted.cubic.channel] <= bound(fitted.cubic, export.span)
        assert set(export.as_json()["channels"]) == set(CHANNELS)


@pytest.mark.parametrize(
    ("target", "words"),
    [
        (Target(Format.PX4, 4), "sensors 0 to 3"),
        (Target(Format.PX4, -1), "sensors 0 to 3"),
        (Target(Format.ARDUPILOT, 3), "sensors 0 to 2"),
        (Target(Format.ARDUPILOT, device_ids={"linear_acceleration": 5}), "--device-id: ArduPilot"),
        (Target(Format.PX4, device_ids={"linear_acceleration": 0}), "--device-id 0: give"),
        (Target(Format.PX4, device_ids={"angular_velocity": 2**32}), "--gyro-device-id 4294967296: give"),
    ],
)
def test_what_the_autopilot_does_not_have_is_refused(target, words):
    with pytest.raises(RefusedError, match=words):
        make_export(ALL, target)


def warnings(calibration, target):
    return " | ".join(make_export(calibration, target).warnings)


def test_warnings_name_what_to_do():
    assert "--device-id" in warnings(ACCELEROMETER, Target(Format.PX4))
    assert warnings(ACCELEROMETER, Target(Format.PX4, device_ids={"linear_acceleration": 5})) == ""
    ids = {"linear_acceleration": 5, "angular_velocity": 6}
    assert "--gyro-device-id is not used" in warnings(ACCELEROMETER, Target(Format.PX4, device_ids=ids))
    assert "INS_TCAL1_GYR1 to 3" in warnings(ACCELEROMETER, Target(Format.ARDUPILOT))
    assert "10 °C or more" in warnings(ALL, Target(Format.ARDUPILOT, span=(20.0, 25.0)))
    assert "±3.5 m/s²" in warnings(ALL, Target(Format.ARDUPILOT))
    one = make_calibration(channels=["linear_acceleration.z"])
    assert "no calibration of linear_acceleration.x, linear_acceleration.y" in warnings(one, Target(Format.PX4))
    assert len(AXES) == 3
