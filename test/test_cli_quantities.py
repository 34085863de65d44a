import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hgma_compensation.quantities import chosen, count, duration, number, quantity, setting, shown_unit


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (17769.6, "17 770"),
        (47.5, "47.50"),
        (0.0021996, "0.002200"),
        (1811.9, "1812"),
        (9999.96, "10 000"),
        (-18108.3, "-18 110"),
        (3.2e-5, "3.200e-05"),
        (4e12, "4.000e+12"),
        (0.0, "0"),
        (None, "-"),
        (math.nan, "-"),
    ],
)
def test_what_was_measured_has_four_digits(value, shown):
    assert number(value) == shown


@given(st.floats(1e-12, 1e12) | st.floats(-1e12, -1e-12))
def test_a_number_that_is_shown_is_the_number(value):
    assert float(number(value).replace(" ", "")) == pytest.approx(value, rel=5.001e-4)


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (17769.6, "m/s^2", "17 770 m/s² (1812 g)"),
        (999.9, "m/s^2", "999.9 m/s²"),
        (-2000.0, "m/s^2", "-2000 m/s² (-203.9 g)"),
        (5000.0, "rad/s", "5000 rad/s"),
        (2000.0, "m/s^2/√Hz", "2000 m/s²/√Hz"),
        (None, "m/s^2", "-"),
        (3.5, "", "3.500"),
    ],
)
def test_high_accelerations_are_told_in_g_too(value, unit, shown):
    assert quantity(value, unit) == shown


def test_what_was_chosen_is_shown_as_it_was_given():
    assert (setting(60.0), setting(9.80665), chosen(900.0, "s"), setting(48000.0)) == (
        "60",
        "9.80665",
        "900 s",
        "48 000",
    )
    assert (count(9999), count(1234567)) == ("9999", "1 234 567")


def test_powers_are_raised():
    assert shown_unit("m/s^2/°C^2") == "m/s²/°C²"
    assert shown_unit("s^-1") == "s⁻¹"
    assert shown_unit("°C") == "°C"


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [
        (0.02, "0.02 s"),
        (9.6798, "9.68 s"),
        (45.0, "45 s"),
        (59.96, "1 min"),
        (90.0, "1 min 30 s"),
        (3599.9, "1 h"),
        (7980.0, "2 h 13 min"),
        (24199.5, "6 h 43 min"),
        (273600.0, "3 d 4 h"),
        (86399.0, "1 d"),
        (-90.0, "-1 min 30 s"),
    ],
)
def test_a_time_has_its_two_largest_units(seconds, shown):
    assert duration(seconds) == shown


@given(st.floats(60.0, 1e7))
def test_a_time_that_is_shown_is_the_time(seconds):
    sizes = {"d": 86400, "h": 3600, "min": 60, "s": 1}
    words = duration(seconds).split()
    told = sum(int(words[i]) * sizes[words[i + 1]] for i in range(0, len(words), 2))
    finest = {"d": 3600, "h": 60, "min": 1}[words[1]]
    assert abs(told - seconds) <= 0.5 * finest
    assert len(words) in (2, 4)
