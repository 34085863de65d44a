"""The managed node's transitions, good and bad, over DDS."""

import sys
import time
from pathlib import Path

import pytest
from builders import EPOCH, make_calibration
from lifecycle_msgs.srv import ChangeState
from robot import imu, thermistor

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.demo.processes import running
from hgma_compensation.stamps import NANOSECONDS
from hgma_msgs.msg import CompensationState

pytestmark = pytest.mark.ros
MAIN = "from hgma_compensation.node.main import main\nimport sys\nsys.exit(main())"
CYCLES = 50


@pytest.fixture
def node(environment, tmp_path):
    """Return a function that runs the node, with a defect put into it where ``defect`` is a program that does so."""
    write_calibration(make_calibration(), tmp_path / "cal.json")

    def run(*parameters, defect="", ready="using calibration"):
        given = (f"calibration_file:={tmp_path / 'cal.json'}", *parameters)
        words = [word for parameter in given for word in ("-p", parameter)]
        program = ["-c", f"{defect}\n{MAIN}"] if defect else ["-m", "hgma_compensation.node.main"]
        return running([sys.executable, *program, "--ros-args", *words], environment, ready)

    return run


def managed(node, *parameters, **options):
    return node("autostart:=false", *parameters, ready="waiting to be configured", **options)


def sample(number):
    return imu(EPOCH + number * 10_000_000, [float(number)] * 6)


def entities(robot):
    """Return the topics and services of the node as the graph shows them, in order."""
    robot.find_node()
    graph = robot.node
    lists = (
        graph.get_publisher_names_and_types_by_node("compensation_node", "/"),
        graph.get_subscriber_names_and_types_by_node("compensation_node", "/"),
        graph.get_service_names_and_types_by_node("compensation_node", "/"),
    )
    return [sorted(name for name, _ in names) for names in lists]


def resident(pid):
    """Return the resident memory of a process in MB."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024.0


def test_a_transition_that_the_state_does_not_allow_is_answered_and_changes_nothing(robot, node):
    with managed(node):
        for transition in ("activate", "deactivate", "cleanup", "no_such_transition"):
            assert not robot.change_state(transition)
        request = ChangeState.Request()
        for number in (3, 99, 255):  # activate, and two that no state has
            request.transition.id = number
            assert not robot.call(ChangeState, "change_state", transition=request.transition).success
        assert robot.lifecycle() == "unconfigured"
        assert robot.change_state("configure")
        assert not robot.change_state("configure")
        assert robot.change_state("activate")
        assert not robot.change_state("cleanup")
        assert robot.lifecycle() == "active"


@pytest.mark.parametrize("before", [(), ("configure",), ("configure", "activate")])
def test_shutdown_ends_every_state_and_signals_still_end_the_process(robot, node, before):
    with managed(node):
        for transition in before:
            assert robot.change_state(transition)
        assert robot.change_state("shutdown")
        assert robot.lifecycle() == "finalized"
        assert not robot.change_state("configure")
        robot.wait(lambda: not any("/accel/" in name for name in entities(robot)[0]), "the topics to be closed")


def test_the_inactive_node_publishes_nothing_and_keeps_its_history(robot, node):
    with managed(node):
        assert robot.change_state("configure")
        robot.connect()
        for number in range(3):
            robot.temperature.publish(thermistor(EPOCH + (number - 3) * NANOSECONDS, 30.0))
        robot.raw.publish(sample(0))
        robot.wait(lambda: robot.diagnosis()[2].get("node_not_active") == "1", "the sample that is skipped")
        assert not robot.compensated
        assert not robot.states
        assert robot.change_state("activate")
        robot.raw.publish(sample(1))
        robot.wait(lambda: robot.states, "output")
        assert robot.states[0].temperature == pytest.approx(30.0, abs=0.01)
        assert robot.change_state("deactivate")
        robot.raw.publish(sample(2))
        robot.wait(lambda: robot.diagnosis()[2]["node_not_active"] == "2", "the second one")
        assert robot.change_state("activate")
        robot.raw.publish(sample(3))
        robot.wait(lambda: len(robot.states) == 2, "output again")
        assert robot.states[1].temperature == pytest.approx(30.0, abs=0.01)
        assert robot.states[1].temperature_status != CompensationState.TEMPERATURE_MISSING
        assert len(robot.compensated) == 2


def test_transitions_while_samples_stream_in_lose_none_of_them_unseen(robot, node):
    with managed(node, "state_rate:=0.0"):
        assert robot.change_state("configure")
        robot.connect()
        for number in range(300):
            if number % 50 == 0:
                assert robot.change_state("activate" if number % 100 == 0 else "deactivate")
            robot.raw.publish(sample(number))
            time.sleep(0.005)
        robot.wait(lambda: robot.diagnosis()[2]["samples_received"] == "300", "all samples to be counted")
        values = robot.diagnosis()[2]
    assert int(values["samples_compensated"]) == len(robot.compensated) == len(robot.states)
    assert int(values["samples_compensated"]) + int(values["node_not_active"]) == 300
    assert min(int(values["samples_compensated"]), int(values["node_not_active"])) > 0


def test_configuring_and_cleaning_up_again_and_again_leaves_nothing_behind(robot, node):
    def cycle():
        for transition in ("configure", "activate", "deactivate", "cleanup"):
            assert robot.change_state(transition)

    with managed(node) as process:
        for _ in range(5):
            cycle()
        robot.wait(lambda: not any("/accel/" in name for name in entities(robot)[0]), "the topics to be closed")
        before, memory = entities(robot), resident(process.pid)
        for _ in range(CYCLES):
            cycle()
        robot.wait(lambda: entities(robot) == before, "the entities of the first cycles")
        growth = resident(process.pid) - memory
        print(f"resident memory: {memory:.1f} MB, {growth:+.2f} MB in {CYCLES} cycles")
        assert growth < 0.1 * CYCLES
        assert robot.change_state("configure")
        assert robot.change_state("activate")
        robot.connect()
        robot.raw.publish(sample(0))
        robot.wait(lambda: robot.compensated, "output after all that")


FAILING_OPEN = """
from hgma_compensation.node.endpoints import Endpoints
publish = Endpoints.publish
def broken(self, message_type, topic):
    if topic == "accel/state":
        raise OSError("the wire is cut")
    return publish(self, message_type, topic)
Endpoints.publish = broken
"""

FAILING_ONCE = """
from hgma_compensation.node.compensation_node import CompensationNode
enter = CompensationNode._enter
def broken(self, state):
    if state == "active":
        CompensationNode._enter = enter
        raise OSError("the wire is cut")
    enter(self, state)
CompensationNode._enter = broken
"""


def test_an_error_in_configure_closes_what_was_opened_and_is_said_in_a_line(robot, node):
    log = robot.log()
    with managed(node, defect=FAILING_OPEN):
        assert not robot.change_state("configure")
        assert robot.lifecycle() == "unconfigured"
        robot.wait(lambda: any("on_configure failed: OSError: the wire is cut" in line for line in log), "the log")
        robot.wait(lambda: not any("/accel/" in name for side in entities(robot)[:2] for name in side), "no topics")
        robot.diagnosis()  # still there to be asked
    assert not any("Traceback" in line for line in log)


def test_an_error_in_activate_leads_back_to_unconfigured_from_where_it_starts_again(robot, node):
    log = robot.log()
    with managed(node, defect=FAILING_ONCE):
        assert robot.change_state("configure")
        assert not robot.change_state("activate")
        assert robot.lifecycle() == "unconfigured"
        assert robot.diagnosis()[2]["lifecycle_state"] == "unconfigured"
        assert robot.change_state("configure")
        assert robot.change_state("activate")
        robot.connect()
        robot.raw.publish(sample(0))
        robot.wait(lambda: robot.compensated, "output after the error")
        assert sum("on_activate failed: OSError: the wire is cut" in line for line in log) == 1


FAILING_CLOSE = """
from hgma_compensation.node.endpoints import Endpoints
def broken(self):
    raise OSError("the wire is cut")
Endpoints.close = broken
"""


def test_an_error_in_clean_up_and_in_its_repetition_ends_in_finalized_without_output(robot, node):
    with node(defect=FAILING_CLOSE):
        robot.connect()
        robot.raw.publish(sample(0))
        robot.wait(lambda: robot.compensated, "output before the error")
        assert robot.change_state("deactivate")
        assert robot.change_state("activate")
        assert not robot.change_state("shutdown")
        assert robot.lifecycle() == "finalized"
        robot.raw.publish(sample(1))
        assert robot.diagnosis()[2]["lifecycle_state"] == "finalized"
        robot.wait(lambda: robot.diagnosis()[2].get("node_not_active") == "1", "the sample that is skipped")
        assert len(robot.compensated) == 1
