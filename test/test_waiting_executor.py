"""Callbacks that are waited for in one thread and run in another."""

import threading
import time

import pytest

from hgma_compensation.demo.ros_domain import take_domain

pytestmark = pytest.mark.ros


class Loop:
    """A node, its executor, and what wakes the thread that runs callbacks."""

    def __init__(self, domain):
        import rclpy  # loads ROS, which most tests do without

        from hgma_compensation.node.waiting_executor import WaitingExecutor

        self.context = rclpy.Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        self.node = rclpy.create_node("waiting", context=self.context)
        self._woken = threading.Event()
        self.executor = WaitingExecutor(self._woken.set, context=self.context)
        self.executor.add_node(self.node)

    def run(self, condition, timeout=20.0):
        """Run callbacks until a condition holds."""
        end = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < end
            self._woken.wait(0.05)
            self._woken.clear()
            self.executor.spin_once()

    def close(self):
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


@pytest.fixture(scope="module")
def domain():
    return take_domain()


@pytest.fixture
def loop(domain):
    made = Loop(domain)
    yield made
    made.close()
    assert not [thread for thread in threading.enumerate() if thread.name == "waiting"]


def test_callbacks_run_one_at_a_time_in_the_thread_that_asks_for_them(loop):
    threads, running = [], []

    def callback():
        assert not running
        running.append(1)
        time.sleep(0.002)
        threads.append(threading.current_thread())
        running.pop()

    for _ in range(3):
        loop.node.create_timer(0.01, callback)
    loop.executor.start()
    loop.run(lambda: len(threads) >= 30)
    assert set(threads) == {threading.main_thread()}


def test_what_is_created_and_destroyed_in_a_callback_is_waited_for_at_once(loop):
    ticks = []

    def replace():
        loop.node.destroy_timer(timers.pop())
        ticks.append(1)
        timers.append(loop.node.create_timer(0.001, replace))

    timers = [loop.node.create_timer(0.001, replace)]
    loop.executor.start()
    loop.run(lambda: len(ticks) >= 50)


def test_an_exception_of_a_callback_is_raised_where_it_runs(loop):
    def broken():
        raise ZeroDivisionError("a defect")

    loop.node.create_timer(0.001, broken)
    loop.executor.start()
    with pytest.raises(ZeroDivisionError, match="a defect"):
        loop.run(lambda: False)


def test_a_context_that_is_shut_down_ends_the_loop(loop):
    from rclpy.executors import ExternalShutdownException

    loop.executor.start()
    loop.context.shutdown()
    with pytest.raises(ExternalShutdownException):
        loop.run(lambda: False)


@pytest.mark.parametrize("wait", [0.0, 0.05])
def test_it_ends_with_a_callback_that_is_ready_and_has_not_run(loop, wait):
    ran = []
    loop.node.create_timer(0.001, lambda: ran.append(1))
    loop.executor.start()
    time.sleep(wait)
    loop.executor.shutdown()
    assert not ran
