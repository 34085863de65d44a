"""The diagnostics of the real node against their table in the documents."""

import re
import sys
from pathlib import Path

import pytest
from builders import EPOCH, make_calibration
from robot import imu, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.kalman.settings import FilterMode
from hgma_compensation.pipeline.reasons import REMEDIES
from hgma_compensation.stamps import NANOSECONDS

pytestmark = pytest.mark.ros
RELIABILITY = Path(__file__).parents[1] / "docs" / "RELIABILITY.md"


def documented():
    """Return the names in the first column of the table of values; a channel stands for any."""
    section = RELIABILITY.read_text(encoding="utf-8").partition("\n## Diagnostics\n")[2].partition("\n#")[0]
    cells = re.findall(r"^\| (`[^|]+) \|", section, re.MULTILINE)
    return {name.replace("<channel>", "") for cell in cells for name in re.findall(r"`([\w<>]+)`", cell)}


def test_every_value_of_the_diagnostics_is_documented(environment, robot, tmp_path):
    write_calibration(make_calibration(mode=FilterMode.SMOOTH), tmp_path / "cal.json")
    given = (f"calibration_file:={tmp_path / 'cal.json'}", f"state_file:={tmp_path / 'state.json'}")
    words = [word for parameter in given for word in ("-p", parameter)]
    with running([sys.executable, "-m", "hgma_compensation.node.main", "--ros-args", *words], environment, "using"):
        robot.connect()
        for second in range(600):
            stamp = EPOCH + second * NANOSECONDS
            robot.temperature.publish(thermistor(stamp, 25.0))
            robot.raw.publish(imu(stamp, [9.81] * 6))
            if second % 30 == 29:  # a thermistor that runs a minute ahead would be another story
                robot.wait(lambda sent=second + 1: len(robot.states) == sent, "the outputs")
        robot.wait(lambda: "nis_linear_acceleration.x" in robot.diagnosis()[2], "a judgement of the noise")
        values = {re.sub(r"(linear_acceleration|angular_velocity)\.[xyz]$", "", name) for name in robot.diagnosis()[2]}
    assert values - set(REMEDIES) == documented() - set(REMEDIES)
