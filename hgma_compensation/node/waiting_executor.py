"""An executor whose waiting is done in a thread of its own, and whose callbacks run in the thread of the samples."""

import threading
from collections.abc import Callable

from rclpy.callback_groups import CallbackGroup
from rclpy.context import Context
from rclpy.executors import Executor, ShutdownException
from rclpy.task import Task


class Unwaited(CallbackGroup):
    """Keeps subscriptions out of the executor's wait set, and the events of their QoS too.

    In Fast DDS a message that waits wakes those who wait for an event of the same subscription, again and again.
    """

    def can_execute(self, entity: object) -> bool:
        """Return that the executor may not wait for an entity of this group."""
        return False


class WaitingExecutor(Executor):
    """Hands callbacks that are ready over one at a time; the thread that waits stands still while one of them runs.

    So nothing is created or destroyed while the wait set is made, and callbacks need no locks.
    """

    def __init__(self, wake: Callable[[], None], *, context: Context | None = None) -> None:
        """Take the function that wakes the thread which calls ``spin_once``."""
        super().__init__(context=context)
        self._wake_caller = wake
        self._ready: Task | None = None
        self._error: BaseException | None = None
        self._ended = False
        self._done = threading.Semaphore(0)
        self._thread = threading.Thread(target=self._wait, name="waiting")

    def start(self) -> None:
        """Begin to wait."""
        self._thread.start()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run the callback that is ready, if there is one; never waits.

        Raises what the callback raises, and ExternalShutdownException where the context was shut down.
        """
        if self._error is not None:
            raise self._error
        task, self._ready = self._ready, None
        if task is None:
            return
        task()
        task.result()
        self._done.release()

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """End the thread that waits; what is ready and has not run does not run any more."""
        if not self._ended:
            self._ended = True
            self._is_shutdown = True
            self._done.release()
            self.wake()
            if self._thread.is_alive():
                self._thread.join()
            if self._ready is not None:
                self._ready.cancel()
        return bool(super().shutdown(timeout_sec))

    def _wait(self) -> None:
        try:
            while not self._is_shutdown:
                self._ready = self.wait_for_ready_callbacks()[0]
                self._wake_caller()
                self._done.acquire()
        except ShutdownException:
            pass
        except BaseException as error:
            self._error = error
            self._wake_caller()
