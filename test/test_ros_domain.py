import subprocess
import sys

import pytest

from hgma_compensation.demo import ros_domain
from hgma_compensation.demo.processes import private_ros_environment

TAKE = """
from hgma_compensation.demo.ros_domain import take_domain
print(*[take_domain() for _ in range({})], flush=True)
input()
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Let locks lie where no other run looks, and give up those of this test."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(ros_domain.tempfile, "tempdir", None)
    monkeypatch.setattr(ros_domain, "_held", [])
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    yield
    for descriptor in ros_domain._held:
        ros_domain.os.close(descriptor)


def another_run(domains):
    """Return a process that holds so many domains until it is told to end, and which they are."""
    process = subprocess.Popen(
        [sys.executable, "-c", TAKE.format(domains)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    return process, [int(word) for word in process.stdout.readline().split()]


def test_two_runs_never_share_a_domain_and_one_that_ended_leaves_its_own():
    process, theirs = another_run(99)
    ours = ros_domain.take_domain()
    assert sorted([*theirs, ours]) == list(ros_domain.DOMAINS)
    with pytest.raises(RuntimeError, match=r"all ROS domains are taken: .* set ROS_DOMAIN_ID"):
        ros_domain.take_domain()
    process.communicate("\n")
    assert ros_domain.take_domain() in theirs


def test_a_run_that_was_killed_leaves_its_domains():
    process, theirs = another_run(100)
    process.kill()
    process.communicate()
    assert ros_domain.take_domain() in theirs


def test_environments_of_one_run_are_apart_too_and_stay_on_this_machine():
    environments = [private_ros_environment() for _ in range(20)]
    assert len({environment["ROS_DOMAIN_ID"] for environment in environments}) == 20
    assert {environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] for environment in environments} == {"LOCALHOST"}


def test_a_domain_that_the_user_names_is_kept(monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    assert private_ros_environment()["ROS_DOMAIN_ID"] == "42"
    assert not ros_domain._held


def test_a_lock_that_cannot_be_opened_is_passed_over(tmp_path):
    for domain in ros_domain.DOMAINS[:-1]:
        (tmp_path / f"hgma_ros_domain_{domain}.lock").symlink_to("elsewhere")
    assert ros_domain.take_domain() == ros_domain.DOMAINS[-1]
