"""QoS of the node's inputs under which nothing is lost on the way: what is tested then is the node."""

from hgma_compensation import topics

RELIABLE = [
    f"qos_overrides./{topic}.subscription.{name}:={value}"
    for topic in topics.INPUTS
    for name, value in (("reliability", "reliable"), ("depth", 10_000))
]
"""Parameters of the node."""
