"""The message definitions that are kept here, against those that rosbags has of ROS 2 Jazzy."""

import pytest
from rosbags.typesys import Stores, get_typestore

from hgma_compensation.recording import typestore as types
from hgma_compensation.recording.bag_reader import open_bag
from hgma_compensation.recording.bag_writer import Storage, new_bag


@pytest.mark.parametrize("name", types.STANDARD)
def test_definitions_are_those_of_jazzy(name):
    jazzy, own = get_typestore(Stores.ROS2_JAZZY), types.typestore()
    assert own.hash_rihs01(name) == jazzy.hash_rihs01(name)
    assert own.generate_msgdef(name) == jazzy.generate_msgdef(name)


def test_messages_of_other_packages_are_known_where_they_are_asked_for():
    assert types.typestore_of(types.IMU) is types.typestore()
    path = "nav_msgs/msg/Odometry"
    assert path not in types.typestore().fielddefs
    assert {path, types.IMU, types.STATE} <= set(types.typestore_of(path).fielddefs)
    assert types.typestore_of(path).hash_rihs01(types.STATE) == types.typestore().hash_rihs01(types.STATE)


@pytest.mark.parametrize("storage", list(Storage))
def test_a_topic_of_another_package_is_copied_with_its_definition(tmp_path, storage):
    odometry = "nav_msgs/msg/Odometry"
    with new_bag(tmp_path / "bag", storage) as bag:
        bag.write_raw(bag.topic("/odometry", odometry), 1, b"\0\1\0\0")
    with open_bag(tmp_path / "bag") as source, new_bag(tmp_path / "copy", storage) as bag:
        bag.write_raw(bag.copy_topic(source.connections[0]), 1, b"\0\1\0\0")
    with open_bag(tmp_path / "copy") as bag:
        (copied,) = bag.connections
    assert copied.msgtype == odometry
    assert "geometry_msgs/PoseWithCovariance pose" in copied.msgdef.data
    assert copied.digest == get_typestore(Stores.ROS2_JAZZY).hash_rihs01(odometry)
