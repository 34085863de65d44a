"""Resolves fields of the node's topics against the message definitions, as plotting tools name them."""

import re

from rosbags.typesys.store import Nodetype

from hgma_compensation import topics
from hgma_compensation.recording import typestore as types

DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
TYPES = {
    topics.in_bag(topics.RAW): types.IMU,
    topics.in_bag(topics.COMPENSATED): types.IMU,
    topics.in_bag(topics.RAW_BLOCK): types.ACCEL_BLOCK,
    topics.in_bag(topics.COMPENSATED_BLOCK): types.ACCEL_BLOCK,
    topics.in_bag(topics.TEMPERATURE): types.TEMPERATURE,
    topics.in_bag(topics.TEMPERATURE_2): types.TEMPERATURE,
    topics.in_bag(topics.SUPPLY_VOLTAGE): types.SUPPLY_VOLTAGE,
    topics.in_bag(topics.STATE): types.STATE,
    "/diagnostics": DIAGNOSTICS,
}


def field_type(topic, fields):
    """Return the type of a field such as linear_acceleration.x or drift[0]; KeyError where there is none."""
    message, base = TYPES[topic], None
    for name, index in re.findall(r"(\w+)(?:\[(\d+)\])?", fields):
        kind, description = dict(types.typestore().fielddefs[message][1])[name]
        if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            kind, description = description[0]
            assert index, f"{topic}.{fields}: {name} is an array"
        else:
            assert not index, f"{topic}.{fields}: {name} is no array"
        message, base = (description, None) if kind == Nodetype.NAME else (None, description[0])
    assert base is not None, f"{topic}.{fields} is a message"
    return base
