"""The topics of a recording in a folder: which are the node's, and whether one can train on them."""

from collections.abc import Iterable
from pathlib import Path

from hgma_compensation import topics
from hgma_compensation.cli.folder import RecordingHere, recording_at
from hgma_compensation.errors import RefusedError

IMU, TEMPERATURE, BLOCK = "sensor_msgs/msg/Imu", "sensor_msgs/msg/Temperature", "hgma_msgs/msg/AccelBlock"

FEWEST_TEMPERATURES = 50
"""Messages of the thermistor that a training needs at the least (training.thermistor, which takes long to load)."""


def usable(one: RecordingHere) -> bool:
    """Return whether a recording is one of a raw accelerometer that can be trained on.

    A file without a folder tells nothing of its topics, and is believed.
    """
    return complaint(one) is None and not _compensated(one)


def complaint(one: RecordingHere) -> str | None:
    """Return what a recording lacks for training, and the remedy, None where it lacks nothing."""
    if not one.topics:
        return None
    if _accelerometer(one) is None:
        return "holds no sensor_msgs/Imu: record the accelerometer's topic"
    temperature = _temperature(one)
    if temperature is None:
        return "holds no sensor_msgs/Temperature: record the thermistor's topic beside the accelerometer's"
    if next(topic.messages for topic in one.topics if topic.name == temperature) < FEWEST_TEMPERATURES:
        return f"holds fewer than {FEWEST_TEMPERATURES} samples of the thermistor: too short to train on"
    return None


def remaps(one: RecordingHere) -> tuple[str, ...]:
    """Return the --remap options that tell the names of the topics in a recording, where they are not the node's."""
    words: list[str] = []
    for ours, theirs in ((_raw(one), _accelerometer(one)), (topics.in_bag(topics.TEMPERATURE), _temperature(one))):
        if theirs is not None and theirs != ours:
            words += ["--remap", f"{ours}:={theirs}"]
    return tuple(words)


def declared_messages(bags: Iterable[Path], names: topics.TopicNames) -> int | None:
    """Return how many messages the bags declare on the node's inputs, for a bar; None where one does not tell.

    Raises RefusedError where a bag plainly has an input under another name, with the option that tells it.
    """
    total, known = 0, True
    wanted = {names[topic] for topic in topics.INPUTS}
    for bag in bags:
        one = recording_at(bag)
        if one is None:
            known = False
        else:
            _check_names(one, names)
            total += sum(topic.messages for topic in one.topics if topic.name in wanted)
    return total if known and total else None


def _check_names(one: RecordingHere, names: topics.TopicNames) -> None:
    held = {topic.name for topic in one.topics}
    for ours, theirs in (
        ((topics.RAW, topics.RAW_BLOCK), _accelerometer(one)),
        ((topics.TEMPERATURE,), _temperature(one)),
    ):
        if theirs is not None and not held & {names[topic] for topic in ours}:
            alike = topics.in_bag(ours[0]) if len(ours) == 1 else _raw(one)
            raise RefusedError(
                f"bag {one.path} holds no {names[ours[0]]}, only {', '.join(sorted(held))}: "
                f"add --remap {alike}:={theirs}"
            )


def _raw(one: RecordingHere) -> str:
    blocks = any(topic.name == _accelerometer(one) and topic.type == BLOCK for topic in one.topics)
    return topics.in_bag(topics.RAW_BLOCK if blocks else topics.RAW)


def _accelerometer(one: RecordingHere) -> str | None:
    return _first(one, IMU, topics.RAW) or _first(one, BLOCK, topics.RAW_BLOCK)


def _temperature(one: RecordingHere) -> str | None:
    return _first(one, TEMPERATURE, topics.TEMPERATURE)


def _first(one: RecordingHere, message_type: str, ours: str) -> str | None:
    """Return the topic of a type: the node's own, else the one with the most messages; None where there is none."""
    fitting = [topic for topic in one.topics if topic.type == message_type and topic.messages]
    if any(topic.name == topics.in_bag(ours) for topic in fitting):
        return topics.in_bag(ours)
    return max(fitting, key=lambda topic: (topic.messages, topic.name)).name if fitting else None


def _compensated(one: RecordingHere) -> bool:
    return any(topic.name == topics.in_bag(topics.STATE) for topic in one.topics)
