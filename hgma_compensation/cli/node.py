"""``hgma node``."""

import click

from hgma_compensation.errors import RefusedError


@click.command("node", context_settings={"ignore_unknown_options": True})
@click.argument("ros_arguments", nargs=-1, type=click.UNPROCESSED)
def command(ros_arguments: tuple[str, ...]) -> int:
    """Run compensation_node; ROS_ARGUMENTS are passed on.

    Example: hgma node --ros-args -p calibration_file:=calibration.json -r accel/raw:=imu/data_raw
    """
    try:
        from hgma_compensation.node.main import main  # only this command and play need ROS
    except ImportError as error:
        raise RefusedError(f"rclpy is not installed ({error}): run make, or source your ROS 2 workspace") from error
    return main(["hgma", *ros_arguments])
