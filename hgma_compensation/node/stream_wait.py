"""Waiting for samples, and for nothing else: what an executor waits for costs it more than a sample does."""

from collections.abc import Sequence

from rclpy.context import Context
from rclpy.event_handler import EventHandler
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.subscription import Subscription


class StreamWait:
    """A wait set of rcl that holds some subscriptions and a guard condition, used by one thread.

    A wait set costs the more the more it holds, and an executor's holds services, timers, events and parameters too, is
    made anew for each wake-up, and leads to one message.
    """

    def __init__(self, context: Context) -> None:
        """Watch nothing yet."""
        self._context = context
        self._guard = GuardCondition(None, None, context)
        self.watch(())

    def watch(self, subscriptions: Sequence[Subscription]) -> None:
        """Wait for these subscriptions from now on; none of them may be destroyed while it is watched."""
        self._handles = [subscription.handle for subscription in subscriptions]
        context = self._context.handle
        assert context is not None
        with context:
            self._wait_set = rclpy_implementation.WaitSet(len(self._handles), 1, 0, 0, 0, 0, context)

    def wake(self) -> None:
        """End the wait, or the next one at once; from any thread."""
        self._guard.trigger()

    def wait(self, nanoseconds: int) -> bool:
        """Wait until there is a message or ``wake`` is called, at most so long; return whether there is a message."""
        wait_set, handles = self._wait_set, self._handles
        # rcl forgets what was not ready.
        wait_set.clear_entities()
        for handle in handles:
            wait_set.add_subscription(handle)
        wait_set.add_guard_condition(self._guard.handle)
        wait_set.wait(nanoseconds)
        return any(wait_set.is_ready("subscription", index) for index in range(len(handles)))

    def take_events(self, handlers: Sequence[EventHandler]) -> None:
        """Call back for what the middleware has to say of the QoS of subscriptions or publishers; does not wait."""
        context = self._context.handle
        assert context is not None
        with context:
            wait_set = rclpy_implementation.WaitSet(0, 0, 0, 0, 0, len(handlers), context)
        wait_set.clear_entities()
        for handler in handlers:
            handler.add_to_wait_set(wait_set)
        wait_set.wait(0)
        for handler in handlers:
            if handler.is_ready(wait_set) and (event := handler.take_data()):
                handler.callback(event)
        wait_set.destroy_when_not_in_use()

    def close(self) -> None:
        """Release what it holds of ROS."""
        self._wait_set.destroy_when_not_in_use()
        self._guard.destroy()
