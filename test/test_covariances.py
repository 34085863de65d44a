import numpy as np
import pytest
from builders import LINEAR

from hgma_compensation.channels import CHANNELS
from hgma_compensation.messages import patch_covariances
from hgma_compensation.recording.typestore import IMU, typestore

GYRO = CHANNELS[3:]


def imu_message(linear, angular):
    types = typestore().types
    vector = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
    stamp = types["builtin_interfaces/msg/Time"](1, 0)
    return types[IMU](
        header=types["std_msgs/msg/Header"](stamp, "imu_link"),
        orientation=types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
        orientation_covariance=np.full(9, np.nan),
        angular_velocity=vector,
        angular_velocity_covariance=np.array(angular),
        linear_acceleration=vector,
        linear_acceleration_covariance=np.array(linear),
    )


KNOWN = np.arange(1.0, 10.0)
UNKNOWN = np.zeros(9)


@pytest.mark.parametrize("covariance", [KNOWN, UNKNOWN])
def test_a_valid_covariance_passes_through_where_nothing_is_added(covariance):
    message = imu_message(covariance, KNOWN)
    assert patch_covariances(message, LINEAR, None)
    np.testing.assert_array_equal(message.linear_acceleration_covariance, covariance)


def test_variances_are_added_to_the_diagonal_of_the_channels_covered():
    message = imu_message(KNOWN, UNKNOWN)
    assert patch_covariances(message, (LINEAR[0], LINEAR[2]), np.array([100.0, 200.0]))
    expected = KNOWN.copy()
    expected[0] += 100.0
    expected[8] += 200.0
    np.testing.assert_array_equal(message.linear_acceleration_covariance, expected)
    np.testing.assert_array_equal(message.angular_velocity_covariance, UNKNOWN)
    assert patch_covariances(message, (LINEAR[1], GYRO[1]), np.array([1.0, 7.0]))
    assert message.angular_velocity_covariance[4] == 7.0


@pytest.mark.parametrize(("place", "value"), [(0, np.nan), (1, np.inf), (4, -1.0), (8, -1e-9)])
@pytest.mark.parametrize("added", [None, np.array([2.0])])
def test_one_that_is_none_becomes_unknown(place, value, added):
    broken = KNOWN.copy()
    broken[place] = value
    message = imu_message(broken, broken)
    assert not patch_covariances(message, LINEAR[:1], added)
    expected = UNKNOWN.copy()
    expected[0] = 0.0 if added is None else 2.0
    np.testing.assert_array_equal(message.linear_acceleration_covariance, expected)
    np.testing.assert_array_equal(message.angular_velocity_covariance, broken)
    assert np.isnan(message.orientation_covariance).all()
