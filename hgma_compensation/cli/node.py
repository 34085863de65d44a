"""``hgma node``."""

import click

from hgma_compensation.node.main import main


@click.command("node", context_settings={"ignore_unknown_options": True})
@click.argument("ros_arguments", nargs=-1, type=click.UNPROCESSED)
def command(ros_arguments: tuple[str, ...]) -> int:
    """Run compensation_node; ROS_ARGUMENTS are passed on.

    Example: hgma node --ros-args -p calibration_file:=calibration.json -r accel/raw:=imu/data_raw
    """
    return main(["hgma", *ros_arguments])
