"""Every dependency of both package.xml is a key that rosdep resolves on Ubuntu 24.04, the platform of Jazzy."""

import re
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {"hgma_compensation": ROOT, "hgma_msgs": ROOT / "hgma_msgs"}

RELEASED = {
    "ament_cmake",
    "builtin_interfaces",
    "diagnostic_msgs",
    "launch",
    "launch_ros",
    "lifecycle_msgs",
    "rcl_interfaces",
    "rclpy",
    "rosgraph_msgs",
    "rosidl_default_generators",
    "rosidl_default_runtime",
    "sensor_msgs",
    "std_msgs",
    "std_srvs",
}
"""Packages of ROS itself, released into Jazzy: rosdistro's jazzy/distribution.yaml at its commit
0006cdad667d515a8328dae16964acbaf8fe1ad7."""

SYSTEM = {
    # key: (Ubuntu package, or pip's, and what of pip it is)
    "python3-catkin-pkg-modules": ("python3-catkin-pkg-modules", "catkin_pkg"),
    "python3-click": ("python3-click", "click"),
    "python3-filterpy-pip": ("pip: filterpy", "filterpy"),
    "python3-flake8": ("python3-flake8", "flake8"),
    "python3-hypothesis": ("python3-hypothesis", "hypothesis"),
    "python3-jsonschema": ("python3-jsonschema", "jsonschema"),  # rosdistro pull request 28036
    "python3-matplotlib": ("python3-matplotlib", "matplotlib"),
    "python3-mypy": ("python3-mypy", "mypy"),
    "python3-numpy": ("python3-numpy", "numpy"),
    "python3-pytest": ("python3-pytest", "pytest"),
    "python3-pytest-timeout": ("python3-pytest-timeout", "pytest-timeout"),
    "python3-rich": ("python3-rich", "rich"),  # rosdistro pull request 43386
    "python3-rosbags-pip": ("pip: rosbags", "rosbags"),  # rosdistro pull request 37795
    "python3-scipy": ("python3-scipy", "scipy"),
    "python3-sklearn": ("python3-sklearn", "scikit-learn"),
    "python3-yaml": ("python3-yaml", "PyYAML"),  # rosdistro pull request 15377
}
"""Keys whose rule for Ubuntu names no release, so that it holds for 24.04: read in rosdep/python.yaml at rosdistro's
commit 662921b91a9cc80a2a6af180a73e7bc28eea040b; those that came later, in the pull request that is named, merged."""

WITHOUT_A_KEY = {
    "allantools",
    "cyclonedds",
    "dask",
    "distributed",
    "mcap",
    "mcap-ros2-support",
    "pymoo",
    "pytest-xdist",
    "ruff",
    "selenium",
    "threadpoolctl",
    "types-PyYAML",
}
"""Requirements of setup.py for which none was found: package.xml says so in a comment, and pip installs them."""


@pytest.mark.parametrize("name", PACKAGES)
def test_every_key_has_been_looked_up(name):
    package = parse_package(str(PACKAGES[name] / "package.xml"))
    kinds = ("buildtool_depends", "build_depends", "exec_depends", "test_depends")
    keys = {dependency.name for kind in kinds for dependency in getattr(package, kind)}
    assert keys <= RELEASED | set(SYSTEM) | set(PACKAGES)


def test_package_xml_has_what_setup_py_requires_and_nothing_else():
    source = (ROOT / "setup.py").read_text(encoding="utf-8")
    texts = re.findall(r'"([A-Za-z][\w-]*(?:\[\w+\])?>=[^"]+)"', source)
    wanted = {Requirement(text).name for text in texts if not text.startswith("ros-jazzy")}
    assert {"numpy", "click", "pytest", "filterpy"} <= wanted
    keys = {pip: key for key, (_, pip) in SYSTEM.items()}
    manifest = (ROOT / "package.xml").read_text(encoding="utf-8")
    for name in wanted:
        if name in keys:
            assert f">{keys[name]}<" in manifest, name
        else:
            assert name in WITHOUT_A_KEY, f"{name}: look up its rosdep key"
            assert re.search(rf"\b{name}\b", manifest), f"{name}: say in package.xml that it has no key"
