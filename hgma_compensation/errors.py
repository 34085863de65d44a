"""The one exception that a user's mistake raises."""

LONGEST = 1500
"""Characters of a message; what is quoted in it comes from outside and may be of any size."""


class RefusedError(Exception):
    """Input that is refused.

    Its text is one line for the person who gave the input: which file and field, what is wrong,
    what to do. Commands print it and exit with 2; the node logs it and keeps what it had.
    """

    def __str__(self) -> str:
        """Return the message folded into one line, with nothing in it that a terminal would obey."""
        words = " ".join(super().__str__().split())
        line = "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in words)
        half = LONGEST // 2
        return line if len(line) <= LONGEST else f"{line[:half]} ... {line[-half:]}"
