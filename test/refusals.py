"""What a reader says to a document that may be good or bad."""

from hgma_compensation.errors import RefusedError


def refusal_of(read, *arguments):
    """Return the text of the refusal, None where there was none; any other exception is let through."""
    try:
        read(*arguments)
    except RefusedError as refusal:
        return str(refusal)
    return None
