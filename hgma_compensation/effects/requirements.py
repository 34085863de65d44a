"""What parameters of effects must be beyond lying inside a span, and series of them."""

from hgma_compensation.channels import CHANNELS
from hgma_compensation.errors import RefusedError


def require_channel(name: str, value: str) -> None:
    """Raise RefusedError, naming the parameter, where its value is not a channel."""
    if value not in CHANNELS:
        raise RefusedError(f"{name} is {value[:60]!r}, must be one of {', '.join(CHANNELS)}")


def require_whole(name: str, value: float) -> None:
    """Raise RefusedError, naming the parameter, where its value has a fraction."""
    if value != int(value):
        raise RefusedError(f"{name} is {value!r}, must be a whole number")


def geometric(middle: float, ratio: float, count: float) -> tuple[float, ...]:
    """Return ``count`` numbers, each ``ratio`` times the one before, whose geometric mean is ``middle``."""
    return tuple(middle * ratio ** (k - 0.5 * (count - 1.0)) for k in range(int(count)))
