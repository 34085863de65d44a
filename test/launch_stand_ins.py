"""The few classes of launch and launch_ros that the launch file uses, as recorders.

launch is not on PyPI, so the real ones cannot run here. Arguments are those of Jazzy's launch 3.4 and launch_ros 0.26
(launch_ros/actions/node.py, lifecycle_node.py, parameter_descriptions.py): a name that these do not take is refused, as
is an argument that nobody declared.
"""

import runpy
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

import yaml

ROOT = Path(__file__).parents[1]
LAUNCH_FILE = ROOT / "launch" / "compensation.launch.py"


@dataclass
class LaunchContext:
    launch_configurations: dict


@dataclass
class LaunchDescription:
    entities: list


class DeclareLaunchArgument:
    def __init__(self, name, *, default_value=None, description=None, choices=None):
        self.name, self.default_value, self.description = name, default_value, description


class OpaqueFunction:
    def __init__(self, *, function, args=None, kwargs=None):
        self.function = function


@dataclass
class LaunchConfiguration:
    name: str

    def perform(self, context):
        return context.launch_configurations[self.name]


@dataclass
class FindPackageShare:
    package: str

    def perform(self, _):
        assert self.package == "hgma_compensation"
        return str(ROOT)


@dataclass
class PathJoinSubstitution:
    parts: list

    def perform(self, context):
        return str(Path(*(part if isinstance(part, str) else part.perform(context) for part in self.parts)))


class ParameterValue:
    def __init__(self, value, *, value_type=None):
        assert value_type is str
        assert isinstance(value, str)
        self.value = value


@dataclass(kw_only=True)
class LifecycleNode:
    package: str
    executable: str
    name: str
    namespace: str
    parameters: list = field(default_factory=list)
    remappings: list = field(default_factory=list)
    ros_arguments: list = field(default_factory=list)
    output: str = "log"
    respawn: bool = False
    respawn_delay: float | None = None

    def words(self, folder):
        """Return the arguments of the process as launch_ros makes them; parameters become files in the folder."""
        words = ["--ros-args", *self.ros_arguments, "--ros-args", "-r", f"__node:={self.name}"]
        if self.namespace:
            words += ["-r", f"__ns:=/{self.namespace.strip('/')}"]
        for number, parameters in enumerate(self.parameters):
            path = parameters
            if isinstance(parameters, dict):
                values = {key: getattr(value, "value", value) for key, value in parameters.items()}
                path = folder / f"launch_params_{number}.yaml"
                path.write_text(yaml.safe_dump({"/**": {"ros__parameters": values}}))
            words += ["--params-file", str(path)]
        return words + [word for source, target in self.remappings for word in ("-r", f"{source}:={target}")]


MODULES = {
    "launch": (LaunchContext, LaunchDescription),
    "launch.actions": (DeclareLaunchArgument, OpaqueFunction),
    "launch.substitutions": (LaunchConfiguration, PathJoinSubstitution),
    "launch_ros": (),
    "launch_ros.actions": (LifecycleNode,),
    "launch_ros.parameter_descriptions": (ParameterValue,),
    "launch_ros.substitutions": (FindPackageShare,),
}


def description(monkeypatch):
    """Return what the launch file's generate_launch_description returns."""
    for name, classes in MODULES.items():
        module = ModuleType(name)
        for one in classes:
            setattr(module, one.__name__, one)
        monkeypatch.setitem(sys.modules, name, module)
    return runpy.run_path(str(LAUNCH_FILE))["generate_launch_description"]()


def launched(monkeypatch, **arguments):
    """Return the node that ``ros2 launch hgma_compensation compensation.launch.py NAME:=VALUE …`` starts."""
    entities = description(monkeypatch).entities
    context = LaunchContext({})
    declared = [entity for entity in entities if isinstance(entity, DeclareLaunchArgument)]
    assert set(arguments) <= {argument.name for argument in declared}
    for argument in declared:
        default = argument.default_value
        value = default if isinstance(default, str) else default.perform(context)
        context.launch_configurations[argument.name] = arguments.get(argument.name, value)
    (node,) = (made for entity in entities if isinstance(entity, OpaqueFunction) for made in entity.function(context))
    return node
