"""A process of another DDS implementation: reads the node's outputs with Eclipse Cyclone DDS.

It knows nothing of ROS. Arguments: DOMAIN, the number of samples of each topic to wait for, and the fields of
CompensationState as JSON. Prints "matched", then one JSON line with what was received. A test runs it as a process of
its own: it must not share one with Fast DDS.
"""

import json
import sys
import time
from dataclasses import asdict, dataclass
from types import new_class

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, sequence, uint8, uint32
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

TIMEOUT = 30.0


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Imu(IdlStruct, typename="sensor_msgs::msg::dds_::Imu_"):
    header: Header
    orientation: Quaternion
    orientation_covariance: array[float64, 9]
    angular_velocity: Vector3
    angular_velocity_covariance: array[float64, 9]
    linear_acceleration: Vector3
    linear_acceleration_covariance: array[float64, 9]


SCALARS = {"double": float64, "uint8": uint8, "boolean": bool, "string": str, "std_msgs/Header": Header}


def struct(typename, fields):
    """Return a class for a message; fields: types by name, as ROS writes them."""

    def kind(name):
        return sequence[SCALARS[name[9:-1]]] if name.startswith("sequence<") else SCALARS[name]

    body = {"__annotations__": {name: kind(text) for name, text in fields.items()}}
    return dataclass(new_class("Made", (IdlStruct,), {"typename": typename}, lambda made: made.update(body)))


def read(domain, count, fields):
    participant = DomainParticipant(domain)
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=10)), Policy.History.KeepLast(10 * count))
    state = struct("hgma_msgs::msg::dds_::CompensationState_", fields)
    imus = DataReader(participant, Topic(participant, "rt/accel/compensated", Imu), qos=qos)
    states = DataReader(participant, Topic(participant, "rt/accel/state", state), qos=qos)
    end = time.monotonic() + TIMEOUT
    while not (imus.get_matched_publications() and states.get_matched_publications()) and time.monotonic() < end:
        time.sleep(0.05)
    print("matched", flush=True)
    got = {imus: [], states: []}
    while min(map(len, got.values())) < count and time.monotonic() < end:
        for reader, samples in got.items():
            samples.extend(reader.take(count))
        time.sleep(0.02)
    return got[imus], got[states]


def main():
    imus, states = read(int(sys.argv[1]), int(sys.argv[2]), json.loads(sys.argv[3]))
    print(json.dumps({"compensated": [asdict(message) for message in imus], "state": [asdict(s) for s in states]}))


if __name__ == "__main__":
    main()
