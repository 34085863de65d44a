"""What rclpy's lifecycle node leaves to its users: failed transitions are said, and impossible ones answered."""

import traceback
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TypeVar

from lifecycle_msgs.srv import ChangeState
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn

NodeType = TypeVar("NodeType", bound=LifecycleNode)
Transition = Callable[[NodeType, LifecycleState], TransitionCallbackReturn]


def described(error: BaseException) -> str:
    """Return an error in one line: its class, its text and where it was raised."""
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {' '.join(str(error).split())}{where}"


def reported(transition: Transition[NodeType]) -> Transition[NodeType]:
    """Log an exception of a transition callback, which rclpy swallows, and end the transition as an error."""

    @wraps(transition)
    def guarded(node: NodeType, state: LifecycleState) -> TransitionCallbackReturn:
        try:
            return transition(node, state)
        except Exception as error:
            node.get_logger().error(f"{transition.__name__} failed: {described(error)}")
            return TransitionCallbackReturn.ERROR

    return guarded


class ManagedNode(LifecycleNode):
    """A lifecycle node that outlives a request for a transition that its state does not allow."""

    def __init__(self, name: str) -> None:
        """Create the node with rclpy's lifecycle services."""
        super().__init__(name)
        # rclpy raises such a request through the executor, which ends the process, and the caller gets no answer.
        self._change_state = self._service_change_state.callback
        self._service_change_state.callback = self._on_change_state

    def _on_change_state(self, request: ChangeState.Request, response: ChangeState.Response) -> ChangeState.Response:
        try:
            response = self._change_state(request, response)
        except rclpy_implementation.RCLError:
            response.success = False
            wanted = request.transition.label or f"number {request.transition.id}"
            label = self._state_machine.current_state[1]
            self.get_logger().warning(f"the transition {wanted} is not possible in the state {label}")
        return response
