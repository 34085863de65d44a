"""The node's parameters: one table, and what is said of values and names that do not fit it."""

from collections.abc import Iterable
from dataclasses import dataclass

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter

from hgma_compensation.errors import RefusedError
from hgma_compensation.node import log
from hgma_compensation.pipeline.state_rate import DEFAULT_RATE

Value = bool | int | float | str

QOS_PREFIX = "qos_overrides."


@dataclass(frozen=True)
class ParameterRow:
    """One parameter. read_only: fixed once the node has started.

    bounds: lowest and highest value of a number. choices: the values of a text, where it is one of a few.
    """

    name: str
    default: Value
    description: str
    read_only: bool = False
    bounds: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()

    def descriptor(self) -> ParameterDescriptor:
        """Return what ``ros2 param describe`` shows."""
        kind = Parameter.Type.from_parameter_value(self.default).value
        descriptor = ParameterDescriptor(description=self.description, read_only=self.read_only, type=kind)
        if self.choices:
            descriptor.additional_constraints = f"one of {', '.join(self.choices)}"
        if self.bounds is not None and isinstance(self.default, float):
            lower, upper = self.bounds
            descriptor.floating_point_range = [FloatingPointRange(from_value=float(lower), to_value=float(upper))]
        elif self.bounds is not None:
            lower, upper = self.bounds
            descriptor.integer_range = [IntegerRange(from_value=int(lower), to_value=int(upper), step=1)]
        return descriptor


CALIBRATION_FILE = ParameterRow(
    "calibration_file",
    "",
    "Calibration (JSON written by hgma train); may be set at any time, a refused file changes nothing",
)
CALIBRATION_DIRECTORY = ParameterRow(
    "calibration_directory",
    "",
    "Directory that calibration files must lie in, symbolic links resolved; empty: anywhere",
    read_only=True,
)
EXPECTED_SENSOR_ID = ParameterRow(
    "expected_sensor_id", "", "The sensor_id that a calibration must carry; empty: any", read_only=True
)
AUTOSTART = ParameterRow("autostart", True, "Configure and activate at start-up", read_only=True)
FRAME_ID = ParameterRow(
    "frame_id",
    "",
    "header.frame_id that the accelerometer's messages must have, others are skipped; empty: any, a change is said",
    read_only=True,
)
ON_BAD_TEMPERATURE = ParameterRow(
    "on_bad_temperature",
    "continue",
    "Samples whose temperature is stale, missing, invalid or out of range: continue with a held drift, or stop",
    read_only=True,
    choices=("continue", "stop"),
)
STATE_FILE = ParameterRow(
    "state_file",
    "",
    "File that keeps the memories over a restart, one for each node; empty: none is kept",
    read_only=True,
)
STATE_PERIOD = ParameterRow(
    "state_period",
    10.0,
    "s between two saves; above 60 s a crash looks like a lack of power to effects that warm up",
    read_only=True,
    bounds=(1.0, 3600.0),
)
STATE_MAX_AGE = ParameterRow(
    "state_max_age",
    3600.0,
    "s between the newest stamp in the file and the first sample after which the file is dropped",
    read_only=True,
    bounds=(0.0, 1e7),
)
STATE_RATE = ParameterRow(
    "state_rate",
    DEFAULT_RATE,
    "States (accel/state) in a second of stamps, besides one at each change of status; 0: one with every sample",
    read_only=True,
    bounds=(0.0, 1e6),
)
USE_SIM_TIME = ParameterRow("use_sim_time", False, "Take the time of the diagnostics from /clock")

PARAMETERS = (
    CALIBRATION_FILE,
    CALIBRATION_DIRECTORY,
    EXPECTED_SENSOR_ID,
    AUTOSTART,
    FRAME_ID,
    ON_BAD_TEMPERATURE,
    STATE_RATE,
    STATE_FILE,
    STATE_PERIOD,
    STATE_MAX_AGE,
    USE_SIM_TIME,
)
"""All of them, in the order of params/compensation.yaml."""

_EXAMPLES = {bool: "true or false", int: "a whole number", float: "a number with a decimal point", str: "a text"}
_QOS_VALUES = {
    "history": ("keep_last", "keep_all", "system_default"),
    "reliability": ("reliable", "best_effort", "system_default"),
}


def declare(node: Node) -> None:
    """Declare all parameters.

    Raises RefusedError where a value given at the start has the wrong type or lies outside its range, and where a QoS
    override is none.
    """
    for row in PARAMETERS:
        try:
            if node.has_parameter(row.name):  # use_sim_time: by rclpy, without a description
                node.set_descriptor(row.name, row.descriptor())
            else:
                node.declare_parameter(row.name, row.default, row.descriptor())
        except ParameterException as error:
            raise RefusedError(f"parameter {row.name} must be {_wanted(row)}: {error}") from error
        value = node.get_parameter(row.name).value
        if row.choices and value not in row.choices:
            raise RefusedError(f"parameter {row.name} is {value!r}: write one of {', '.join(row.choices)}")
    for name, value in given(node).items():
        if name.startswith(QOS_PREFIX):
            check_qos_override(name, value)


def _wanted(row: ParameterRow) -> str:
    kind = _EXAMPLES[type(row.default)]
    return kind if row.bounds is None else f"{kind} between {row.bounds[0]:g} and {row.bounds[1]:g}"


def given(node: Node) -> dict[str, object]:
    """Return what command line and parameter files give for this node, known to it or not."""
    # rclpy drops without a word what nobody declares, and has no public way to ask for it.
    return {name: parameter.value for name, parameter in node._parameter_overrides.items()}


def check_qos_override(name: str, value: object) -> None:
    """Raise RefusedError where the value is none that a policy of that name can have."""
    policy = name.rpartition(".")[2]
    if policy == "depth" and (type(value) is not int or value < 1):
        raise RefusedError(f"parameter {name} is {value!r}: write the number of messages to hold, 1 or more")
    if policy in _QOS_VALUES and value not in _QOS_VALUES[policy]:
        raise RefusedError(f"parameter {name} is {value!r}: write one of {', '.join(_QOS_VALUES[policy])}")


def unknown_names(names: Iterable[str], declared: Iterable[str]) -> dict[str, str]:
    """Return the names that are not declared, each with the nearest one that is, "" where none is near."""
    import difflib  # which a start without a mistake does not wait for

    known = sorted(declared)
    return {name: next(iter(difflib.get_close_matches(name, known, 1)), "") for name in names if name not in known}


def warn_of_unknown(node: Node, *, qos: bool) -> None:
    """Say which given parameters have no effect; qos: those of topics, which exist once the topics are open."""
    names = [name for name in given(node) if name.startswith(QOS_PREFIX) == qos]
    declared = list(node.get_parameters_by_prefix(""))
    for name, near in unknown_names(names, declared).items():
        hint = f"did you mean {near}?" if near else "see ros2 param list"
        log.warning(node, f"there is no parameter {name}, its value has no effect: {hint}")
