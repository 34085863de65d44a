"""Entry point of ``hgma``; imports nothing of its own before an interruption is caught."""

import os
import signal
import sys

INTERRUPTED = 130


def main() -> int:
    """Run a command; Ctrl-C in the moments before there is one to interrupt ends it without a traceback."""
    # Where the caller has it ignored, as for a command in the background of a script, it stays so.
    caught = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if caught:
        signal.signal(signal.SIGINT, _interrupted)
    from hgma_compensation.cli.main import main as run

    if caught:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    return run()


def _interrupted(*_: object) -> None:
    # An exception would go through the importing of modules, which may swallow or wrap it.
    os.write(sys.stderr.fileno(), b"interrupted, nothing was written\n")
    os._exit(INTERRUPTED)


if __name__ == "__main__":
    sys.exit(main())
