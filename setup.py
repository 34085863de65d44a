"""Packaging of hgma_compensation: the one place of its metadata, for colcon (ament_python) and for pip."""

import re
from pathlib import Path

from setuptools import find_packages, setup

NAME = "hgma_compensation"
ROOT = Path(__file__).resolve().parent
README = ROOT / "README.md"


def read_version():
    """Take the version out of the package's source: importing it would need its dependencies installed."""
    source = (ROOT / NAME / "__init__.py").read_text(encoding="utf-8")
    return re.search(r'^__version__\s*=\s*"([^"]+)"', source, re.MULTILINE).group(1)


def share_files(*folders):
    """List the files of the folders (those that exist) for data_files, which knows no recursive patterns."""
    files = (path for folder in folders for path in sorted((ROOT / folder).rglob("*")) if path.is_file())
    kept = (path.relative_to(ROOT) for path in files if "__pycache__" not in path.parts)
    return [(f"share/{NAME}/{path.parent}", [str(path)]) for path in kept]


# Lower bounds: what Ubuntu 24.04, the platform of Jazzy, packages. Upper bounds: the next major version.
ROS = [
    "ros-jazzy-rclpy[fastrtps]>=7.1.6,<8",
    "ros-jazzy-common-interfaces>=5.3.6,<6",  # sensor_msgs, std_msgs, std_srvs, diagnostic_msgs
    "ros-jazzy-lifecycle-msgs>=2.0.3,<3",
    "ros-jazzy-rcl-interfaces>=2.0.3,<3",
    "ros-jazzy-rosgraph-msgs>=2.0.3,<3",
]
OFFLINE = [
    "allantools>=2024.6,<2026",
    "click>=8.1,<9",
    "matplotlib>=3.6,<4",
    "pymoo>=0.6.1,<0.7",
    "PyYAML>=6.0,<7",
    "rich>=13.7,<16",
    "rosbags>=0.11,<0.12",
    "threadpoolctl>=3.1,<4",
]
FLEET = ["dask[distributed]>=2025.1,<2027"]  # hgma fleet --scheduler
TEST = [
    *FLEET,
    "catkin_pkg>=1.0,<2",
    "cyclonedds>=11,<12",  # another DDS, which reads what the node publishes
    "flake8>=7.0,<8",  # what ament_flake8 runs
    "hypothesis>=6.98,<7",
    "jsonschema>=4.10,<5",
    "mcap>=1.2,<2",  # another reader of what is written as MCAP
    "mcap-ros2-support>=0.5,<0.7",
    "mypy>=1.15,<3",
    "pytest>=7.4,<10",
    "pytest-timeout>=2.2,<3",
    "pytest-xdist>=3.5,<4",
    "scikit-learn>=1.4,<2",
    "ruff>=0.17,<0.18",  # narrow: the formatter's output may differ from one minor version to the next
    "selenium>=4.20,<5",  # drives the browser that looks at the reports; without one these tests skip
    "types-PyYAML>=6.0,<7",
]

setup(
    name=NAME,
    version=read_version(),
    description="Temperature drift compensation of high-g MEMS accelerometers for ROS 2",
    long_description=README.read_text(encoding="utf-8") if README.exists() else "",
    long_description_content_type="text/markdown",
    license="Apache-2.0",
    author="HGMA developers",
    author_email="hgma@example.org",
    maintainer="HGMA developers",
    maintainer_email="hgma@example.org",
    python_requires=">=3.10",
    packages=find_packages(include=[NAME, f"{NAME}.*"]),
    package_data={NAME: ["py.typed", "**/*.json", "**/*.yaml", "**/*.html"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        *share_files("launch", "params", "bags"),
    ],
    install_requires=["numpy>=1.26,<3", "scipy>=1.11,<2", "filterpy>=1.4.5,<3"],
    extras_require={"ros": ROS, "offline": OFFLINE, "fleet": FLEET, "test": TEST},
    entry_points={
        "console_scripts": [
            f"hgma = {NAME}.cli.entry:main",
            f"compensation_node = {NAME}.node.main:main",
        ],
    },
    zip_safe=False,
)
