"""Topic names, in one place for node, player and bags."""

from collections.abc import Sequence

from hgma_compensation.errors import RefusedError

RAW = "accel/raw"
TEMPERATURE = "accel/temperature"
TEMPERATURE_2 = "accel/temperature_2"
SUPPLY_VOLTAGE = "accel/supply_voltage"
RAW_BLOCK = "accel/raw_block"
COMPENSATED = "accel/compensated"
COMPENSATED_BLOCK = "accel/compensated_block"
STATE = "accel/state"

SLOW_INPUTS = (TEMPERATURE, TEMPERATURE_2, SUPPLY_VOLTAGE)
INPUTS = (RAW, RAW_BLOCK, *SLOW_INPUTS)
OUTPUTS = (COMPENSATED, COMPENSATED_BLOCK, STATE)


def in_bag(topic: str) -> str:
    """Return the name of a topic as a recording of a node without a namespace has it."""
    return "/" + topic.lstrip("/")


class TopicNames:
    """Names in a bag of the topics that the node knows."""

    def __init__(self, remaps: Sequence[str] = ()) -> None:
        """Take ``A:=B`` rules; A is the node's name and B the bag's, or the other way round.

        Raises RefusedError for a rule without a topic of the node on either side.
        """
        self._names = {topic: in_bag(topic) for topic in INPUTS + OUTPUTS}
        for rule in remaps:
            ours, separator, theirs = rule.partition(":=")
            if separator and theirs.lstrip("/") in self._names and ours.lstrip("/") not in self._names:
                ours, theirs = theirs, ours
            if not separator or not theirs or ours.lstrip("/") not in self._names:
                known = ", ".join(in_bag(topic) for topic in self._names)
                raise RefusedError(
                    f"--remap {rule}: write /topic/of/the/node:=/topic/in/the/bag, the former one of {known}"
                )
            self._names[ours.lstrip("/")] = in_bag(theirs)

    def __getitem__(self, topic: str) -> str:
        """Return the name in the bag of one of the node's topics."""
        return self._names[topic]
