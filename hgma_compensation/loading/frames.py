"""Objects through a pipe: each a length and a pickle.

A pickle may do anything to the process that loads it. These cross the private pipes between a process and the child
that it started itself, of the same program, and never come from a file, a topic or a network.
"""

import pickle
from struct import Struct
from typing import BinaryIO

LENGTH = Struct("=Q")


def framed(message: object) -> bytes:
    """Return the bytes that carry an object."""
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    return LENGTH.pack(len(body)) + body


def read_frame(file: BinaryIO) -> object:
    """Return the next object out of a file, waiting for it; raises EOFError where the other end has closed it."""
    return pickle.loads(_exactly(file, *LENGTH.unpack(_exactly(file, LENGTH.size))))


def _exactly(file: BinaryIO, count: int) -> bytes:
    if len(content := file.read(count)) < count:
        raise EOFError("the pipe was closed")
    return content


class Incoming:
    """One object that comes in pieces."""

    def __init__(self) -> None:
        """Start without a piece."""
        self._content = bytearray()

    def feed(self, piece: bytes) -> None:
        """Take the next piece."""
        self._content += piece

    @property
    def complete(self) -> bool:
        """Whether all of the object has come."""
        content = self._content
        return len(content) >= LENGTH.size and len(content) - LENGTH.size >= LENGTH.unpack_from(content)[0]

    def message(self) -> object:
        """Return the object, which is complete."""
        return pickle.loads(memoryview(self._content)[LENGTH.size :])
