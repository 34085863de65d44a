"""A process of another DDS implementation: reads the node's outputs with Eclipse Cyclone DDS.

It knows nothing of ROS. Arguments: DOMAIN and the number of samples of each topic to wait for. Prints "matched", then
one JSON line with what was received. A test runs it as a process of its own: it must not share one with Fast DDS.
"""

import json
import sys
import time
from dataclasses import dataclass

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


@dataclass
class CompensationState(IdlStruct, typename="hgma_msgs::msg::dds_::CompensationState_"):
    header: Header
    temperature: float64
    temperature_rate: float64
    temperature_product: float64
    channels: sequence[str]
    drift: sequence[float64]
    innovation: sequence[float64]
    inside_calibrated_range: bool
    temperature_status: uint8
    filter_mode: sequence[uint8]
    calibration_id: str


def stamp(header):
    return header.stamp.sec * 10**9 + header.stamp.nanosec


def read(domain, count):
    participant = DomainParticipant(domain)
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=10)), Policy.History.KeepLast(10 * count))
    imus = DataReader(participant, Topic(participant, "rt/accel/compensated", Imu), qos=qos)
    states = DataReader(participant, Topic(participant, "rt/accel/state", CompensationState), qos=qos)
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
    imus, states = read(int(sys.argv[1]), int(sys.argv[2]))
    print(
        json.dumps(
            {
                "compensated": [
                    [
                        stamp(m.header),
                        m.header.frame_id,
                        [m.linear_acceleration.x, m.linear_acceleration.y, m.linear_acceleration.z],
                        list(m.linear_acceleration_covariance),
                    ]
                    for m in imus
                ],
                "state": [
                    [stamp(m.header), m.temperature, m.channels, m.drift, m.temperature_status, m.calibration_id]
                    for m in states
                ],
            }
        )
    )


if __name__ == "__main__":
    main()
