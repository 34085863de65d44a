"""Python classes of message types by name; rosidl_runtime_py, which has this too, is not on PyPI."""

import importlib
import re
from typing import Any

MESSAGE_TYPE = re.compile(r"[a-z][a-z0-9_]*/msg/[A-Z][A-Za-z0-9]*")
"""Importing runs code: a name out of a bag must not reach any other module."""


def message_class(name: str) -> Any:
    """Return the class of a type such as "sensor_msgs/msg/Imu".

    Raises ModuleNotFoundError or AttributeError where it is not installed.
    """
    if not MESSAGE_TYPE.fullmatch(name):
        raise ModuleNotFoundError(f"{name!r} is no type of messages")
    package, kind, message = name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), message)
