"""Names in the diagnostics of what happens to messages and clock on the way to the node, and what to do."""

from hgma_compensation import topics

ROS_TIME_JUMPED_BACK = "ros_time_jumped_back"


def lost_name(topic: str) -> str:
    """Return the name of messages of an input that were sent and never arrived."""
    return f"{topic.rpartition('/')[2]}_lost_in_transport"


def incompatible_name(topic: str) -> str:
    """Return the name of other sides of a topic whose QoS does not fit."""
    return f"{topic.rpartition('/')[2]}_qos_incompatible"


def unreadable_name(topic: str) -> str:
    """Return the name of messages of a slow input whose bytes hold none of its type."""
    return f"{topic.rpartition('/')[2]}_unreadable"


_LOST = "the node or the network was too slow for {}: lower its rate or the load, or send blocks"
_INCOMPATIBLE = "{} and its other side do not talk: the log names the policy to set with qos_overrides"

_UNREADABLE = "what is published on {} is damaged or of another type: check its driver"

TRANSPORT_REMEDIES: dict[str, str] = {
    ROS_TIME_JUMPED_BACK: "expected when a bag or simulation starts again; else look for a second publisher of /clock",
    **{lost_name(topic): _LOST.format(topic) for topic in topics.INPUTS},
    **{incompatible_name(topic): _INCOMPATIBLE.format(topic) for topic in topics.INPUTS + topics.OUTPUTS},
    **{unreadable_name(topic): _UNREADABLE.format(topic) for topic in topics.SLOW_INPUTS},
}
