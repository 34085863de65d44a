"""The policy for SROS 2 against what the real node offers and uses."""

import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
from robot import NODE

from hgma_compensation.demo.processes import running

pytestmark = pytest.mark.ros
POLICY = Path(__file__).parents[1] / "params" / "sros2_policy.xml"
RULES = {
    ("topics", "publish"): "get_publisher_names_and_types_by_node",
    ("topics", "subscribe"): "get_subscriber_names_and_types_by_node",
    ("services", "reply"): "get_service_names_and_types_by_node",
    ("services", "request"): "get_client_names_and_types_by_node",
}
DISCOVERY = 10.0
"""s: the topics and services of a node become known one by one."""


def profile():
    """Return the one profile of the policy."""
    root = ElementTree.parse(POLICY).getroot()
    assert (root.tag, root.get("version")) == ("policy", "0.2.0")
    (enclave,) = root.findall("./enclaves/enclave")
    assert enclave.get("path") == NODE
    (found,) = enclave.findall("./profiles/profile")
    return found


def permitted():
    """Return the full names that the policy allows, by kind of name and permission; it has no other rules."""
    found, rules = profile(), {rule: set() for rule in RULES}
    for group in found:
        ((permission, verdict),) = group.attrib.items()
        assert verdict == "ALLOW"
        rules[group.tag, permission] |= {full_name(entry.text, found.attrib) for entry in group}
    return rules


def full_name(name, place):
    if name.startswith("/"):
        return name
    namespace = place["ns"].rstrip("/")
    return f"{namespace}/{place['node']}{name[1:]}" if name.startswith("~") else f"{namespace}/{name}"


def seen(robot):
    """Return the same of the node that runs."""
    name, namespace = NODE.lstrip("/"), "/"
    return {rule: {topic for topic, _ in getattr(robot.node, ask)(name, namespace)} for rule, ask in RULES.items()}


def test_the_policy_allows_exactly_what_the_node_offers_and_uses(environment, robot):
    command = [sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", "-p", "use_sim_time:=true"]
    expected = permitted()
    with running(command, environment, "no calibration yet"):
        robot.connect()
        end = time.monotonic() + DISCOVERY
        while seen(robot) != expected and time.monotonic() < end:
            robot.spin(0.2)
        assert seen(robot) == expected
