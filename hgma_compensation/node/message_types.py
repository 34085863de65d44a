"""Python classes of message types by name; rosidl_runtime_py, which has this too, is not on PyPI."""

import importlib
from typing import Any


def message_class(name: str) -> Any:
    """Return the class of a type such as "sensor_msgs/msg/Imu".

    Raises ModuleNotFoundError or AttributeError where it is not installed.
    """
    package, kind, message = name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), message)
