"""``hgma play``."""

from pathlib import Path

import click

from hgma_compensation.cli import options
from hgma_compensation.cli.json_figures import write_json
from hgma_compensation.cli.progress_bars import counting_bar
from hgma_compensation.cli.ros_node import ros_node, ros_required
from hgma_compensation.quantities import count
from hgma_compensation.recording.bag_reader import open_bag
from hgma_compensation.topics import TopicNames


@click.command("play", epilog="Example: hgma play oven_test --rate 10 --clock")
@options.bag_argument
@click.option(
    "--rate",
    type=click.FloatRange(min=0.0, min_open=True),
    default=1.0,
    show_default=True,
    help="Times faster than recorded.",
)
@click.option("--loop", is_flag=True, help="Begin again at the end, until interrupted.")
@click.option("--clock", is_flag=True, help="Publish the recording's time on /clock, for use_sim_time.")
@click.option(
    "--wait",
    type=click.FloatRange(min=0.0),
    default=0.0,
    show_default=True,
    metavar="S",
    help="Wait for subscribers, at most S seconds.",
)
@options.remap
@options.json_file
def command(
    bag: Path, rate: float, loop: bool, clock: bool, wait: float, names: TopicNames, json_path: Path | None
) -> None:
    """Publish a recording to ROS, each message with the content and stamp it was recorded with."""
    with ros_required():
        from hgma_compensation.node.player import Player, PlayOptions  # only few commands need ROS
    with open_bag(bag) as reader:
        total = reader.message_count
    played, interrupted = 0, False
    try:
        with ros_node("hgma_player") as node, counting_bar("playing", None if loop else total) as advance:

            def tell(messages: int) -> None:
                nonlocal played
                played += messages
                advance(messages)

            played = Player(node, bag, PlayOptions(rate, loop, clock, wait, names), tell).play()
    except KeyboardInterrupt:
        interrupted = True
    click.echo(f"{bag}: {count(played)} messages played{', interrupted' if interrupted else ''}")
    write_json(json_path, {"messages": played, "interrupted": interrupted})
