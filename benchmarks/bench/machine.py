"""What the figures were measured on."""

import os
import platform
import subprocess
from datetime import datetime, timezone
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = (
    "numpy",
    "scipy",
    "scikit-learn",
    "filterpy",
    "rosbags",
    "ros-rclpy",
    "ros-rmw-fastrtps-cpp",
    "ros-fastrtps",
)
UNKNOWN = "not known"


def describe() -> dict[str, str]:
    """Return machine, system, versions and load, each under the name that the document gives it."""
    load = ", ".join(f"{value:.2f}" for value in os.getloadavg())
    described = {
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "revision": _revision(),
        "processor": _first_value(Path("/proc/cpuinfo"), "model name"),
        "cores": str(len(os.sched_getaffinity(0))),
        "memory": _gibibytes(_first_value(Path("/proc/meminfo"), "MemTotal")),
        "kernel": f"{platform.system()} {platform.release()}",
        "load average at the start (1, 5, 15 min)": load,
        "Python": platform.python_version(),
        "middleware": os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp, the default"),
    }
    return described | {name: _version(name) for name in PACKAGES}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # of ROS, where that is a distribution's
        return UNKNOWN


def _first_value(path: Path, key: str) -> str:
    for line in path.read_text(encoding="utf-8").splitlines():
        name, _, value = line.partition(":")
        if name.strip() == key:
            return value.strip()
    return UNKNOWN


def _gibibytes(text: str) -> str:
    kilobytes = text.removesuffix(" kB")
    return f"{int(kilobytes) / 2**20:.1f} GiB" if kilobytes.isdigit() else text


def _revision() -> str:
    command = ["git", "describe", "--always", "--dirty", "--abbrev=10"]
    try:
        done = subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, text=True)
    except FileNotFoundError:
        return UNKNOWN
    return done.stdout.strip() or UNKNOWN
