"""Commands run in this process."""

from hgma_compensation.cli.main import main


def run(*words):
    """Return the exit code of a command."""
    return main([str(word) for word in words])


def refused(capsys, *words):
    """Return the one line with which a command is refused."""
    assert run(*words) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    assert "Traceback" not in error
    return error
