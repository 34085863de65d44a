import numpy as np
import pytest

from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError
from hgma_compensation.training.reference import Reference

ACCELERATION, GYROSCOPE = CHANNELS[:3], CHANNELS[3:]
VALUES = np.zeros((1, 6))


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("mean", ()),
        (" mean ", ()),
        ("9.81", (9.81,)),
        ("-1e2", (-100.0,)),
        ("0, 0,9.81", (0.0, 0.0, 9.81)),
        ("1,2,3,4,5,6", (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)),
    ],
)
def test_text_is_parsed_and_printed_back(text, numbers):
    reference = Reference.parse(text)
    assert reference.numbers == numbers
    assert Reference.parse(str(reference)) == reference


@pytest.mark.parametrize("text", ["", "median", "1,,2", "1;2;3", "nan", "1,inf,2", "1e999", "mean,1"])
def test_text_that_is_neither_is_refused(text):
    with pytest.raises(RefusedError, match=r"--reference .*write mean, one number, or one number for each channel"):
        Reference.parse(text)


def test_default_is_the_mean_of_what_is_finite():
    values = np.array([[1.0, 5.0], [np.nan, 7.0], [3.0, np.inf], [5.0, 9.0]])
    np.testing.assert_array_equal(Reference().of(CHANNELS[:2], values), [3.0, 7.0])


def test_mean_of_a_channel_is_the_same_bits_whichever_channels_stand_beside_it():
    values = 9.81 + np.random.default_rng(20190725).standard_normal((1000, 6))
    together = Reference().of(CHANNELS, values)
    alone = [Reference().of(CHANNELS[k : k + 1], values[:, k : k + 1])[0] for k in range(6)]
    np.testing.assert_array_equal(together, alone)


def test_one_number_is_for_all_channels():
    np.testing.assert_array_equal(Reference((2.5,)).of(CHANNELS, VALUES), np.full(6, 2.5))


@pytest.mark.parametrize(
    ("channels", "expected"),
    [
        (ACCELERATION, [1.0, 2.0, 3.0]),
        (ACCELERATION[::-1], [3.0, 2.0, 1.0]),
        (ACCELERATION[1:], [2.0, 3.0]),
        (ACCELERATION[2:], [3.0]),
    ],
)
def test_three_numbers_are_the_axes_of_the_acceleration(channels, expected):
    np.testing.assert_array_equal(Reference((1.0, 2.0, 3.0)).of(channels, VALUES), expected)


@pytest.mark.parametrize(
    "channels", [GYROSCOPE, (ACCELERATION[2], GYROSCOPE[0], GYROSCOPE[1]), (ACCELERATION[0], GYROSCOPE[2]), CHANNELS]
)
def test_as_many_numbers_as_channels_are_given_in_their_order(channels):
    numbers = tuple(float(k) for k in range(len(channels)))
    np.testing.assert_array_equal(Reference(numbers).of(channels, VALUES), numbers)


@pytest.mark.parametrize(
    ("count", "channels"), [(2, ACCELERATION), (4, ACCELERATION), (3, CHANNELS), (3, GYROSCOPE[:2]), (6, ACCELERATION)]
)
def test_numbers_that_do_not_fit_are_refused(count, channels):
    with pytest.raises(RefusedError, match=f"--reference has {count} numbers for the channels {channels[0]}"):
        Reference((1.0,) * count).of(channels, VALUES)
