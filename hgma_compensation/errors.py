"""The one exception that a user's mistake raises."""


class RefusedError(Exception):
    """Input that is refused.

    Its text is one line for the person who gave the input: which file and field, what is wrong,
    what to do. Commands print it and exit with 2; the node logs it and keeps what it had.
    """

    def __str__(self) -> str:
        """Return the message folded into one line."""
        return " ".join(super().__str__().split())
