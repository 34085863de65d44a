"""The other end of the node's topics: a process's worth of ROS, spun by hand in the test's own thread."""

import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, Temperature
from std_srvs.srv import Trigger

from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import AccelBlock, CompensationState, SupplyVoltage
from hgma_msgs.srv import LoadCalibration

QOS = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=10_000, reliability=ReliabilityPolicy.RELIABLE)
NODE = "/compensation_node"
TIMEOUT = 30.0
SETTLING = 0.3
"""s in which the node learns of what knows of the node already."""


class Robot:
    """Publishes raw samples, collects what the node makes of them, calls its services."""

    def __init__(self, domain: int) -> None:
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self.node = rclpy.create_node("robot", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self.raw = self.node.create_publisher(Imu, "accel/raw", QOS)
        self.raw_block = self.node.create_publisher(AccelBlock, "accel/raw_block", QOS)
        self.temperature = self.node.create_publisher(Temperature, "accel/temperature", QOS)
        self.temperature_2 = self.node.create_publisher(Temperature, "accel/temperature_2", QOS)
        self.supply_voltage = self.node.create_publisher(SupplyVoltage, "accel/supply_voltage", QOS)
        self._clients = {}
        self.compensated = self.collect(Imu, "accel/compensated")
        self.blocks = self.collect(AccelBlock, "accel/compensated_block")
        self.states = self.collect(CompensationState, "accel/state")
        self.diagnostics = self.collect(DiagnosticArray, "/diagnostics")

    def collect(self, message_type, topic):
        messages = []
        self.node.create_subscription(message_type, topic, messages.append, QOS)
        return messages

    def log(self):
        """Return a list of what the node's log says, also what it said before."""
        lines = []
        qos = QoSProfile(
            depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
        )

        def take(entry):
            if entry.name == NODE.lstrip("/"):
                lines.append(entry.msg)

        self.node.create_subscription(Log, "/rosout", take, qos)
        return lines

    def wait(self, condition, what, timeout=TIMEOUT):
        end = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < end, f"waited {timeout} s for {what}"
            self._executor.spin_once(timeout_sec=0.05)

    def send(self, publisher, messages):
        """Publish messages no faster than a busy machine takes them: the node's inputs are best effort."""
        for number, message in enumerate(messages):
            publisher.publish(message)
            if number % 50 == 49:
                self.spin(0.02)

    def find_node(self):
        """Wait until the graph knows of the node."""
        name = (NODE.lstrip("/"), "/")
        self.wait(lambda: name in self.node.get_node_names_and_namespaces(), "the node in the graph")

    def spin(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.05)

    def connect(self):
        """Wait until the node hears all inputs and we hear its outputs."""
        outputs = ("accel/compensated", "accel/compensated_block", "accel/state")
        inputs = (self.raw, self.raw_block, self.temperature, self.temperature_2, self.supply_voltage)
        self.wait(
            lambda: (
                all(publisher.get_subscription_count() for publisher in inputs)
                and all(self.node.count_publishers(topic) for topic in outputs)
            ),
            "the node's topics",
        )
        self.spin(0.5)  # the node's side of the discovery

    def call(self, service_type, name, **fields):
        future = self.client(service_type, f"{NODE}/{name}").call_async(service_type.Request(**fields))
        self.wait(future.done, f"an answer of {name}")
        return future.result()

    def client(self, service_type, name):
        """Return a client that the node knows of: an answer to one that it has not discovered yet would be lost."""
        client = self._clients.get(name)
        if client is None:
            client = self._clients[name] = self.node.create_client(service_type, name)
            self.wait(client.service_is_ready, f"the service {name}")
            self.spin(SETTLING)
        self.wait(client.service_is_ready, f"the service {name}")
        return client

    def load(self, path):
        return self.call(LoadCalibration, "load_calibration", path=str(path))

    def reset(self):
        return self.call(Trigger, "reset")

    def set_parameter(self, name, value):
        message = Parameter(name, value=value).to_parameter_msg()
        return self.call(SetParameters, "set_parameters", parameters=[message]).results[0]

    def lifecycle(self):
        return self.call(GetState, "get_state").current_state.label

    def change_state(self, transition):
        request = ChangeState.Request()
        request.transition.label = transition
        return self.call(ChangeState, "change_state", transition=request.transition).success

    def diagnosis(self):
        """Return the next status of the node: level, message and values by name."""
        del self.diagnostics[:]
        self.wait(lambda: self.diagnostics, "diagnostics")
        status = self.diagnostics[-1].status[0]
        return status.level, status.message, {value.key: value.value for value in status.values}

    def close(self):
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.try_shutdown()


def stamped(message, stamp, frame="imu_link"):
    """Return the message with a header of the given stamp (ns)."""
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(int(stamp), NANOSECONDS)
    message.header.frame_id = frame
    return message


def imu(stamp, values, frame="imu_link"):
    """Return an Imu with six channels."""
    message = stamped(Imu(), stamp, frame)
    a, w = message.linear_acceleration, message.angular_velocity
    a.x, a.y, a.z, w.x, w.y, w.z = (float(value) for value in values)
    return message


def thermistor(stamp, celsius):
    """Return a Temperature."""
    return stamped(Temperature(temperature=float(celsius)), stamp)
