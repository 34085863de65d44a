"""``hgma``: its commands, and the one place where a mistake of the user becomes a line and exit code 2."""

import importlib
import sys
from collections.abc import Sequence

import click

from hgma_compensation import __version__
from hgma_compensation.errors import RefusedError

COMMANDS = {
    "simulate": "an oven test of the simulated high-g accelerometer",
    "import-csv": "a recording out of a table",
    "train": "recordings in, calibration out",
    "evaluate": "error of a recording before and after compensation",
    "diagnose": "name the effect that a calibration lacks, and add it",
    "fleet": "calibrate and judge many sensors, one for each folder",
    "compensate": "a recording with the compensated topics added",
    "play": "publish a recording to ROS",
    "inspect": "a calibration in words",
    "node": "run the ROS 2 node",
}
"""In the order of work; each in the module of its name, imported only when it is called."""

REFUSED = 2
INTERRUPTED = 130


class LazyCommands(click.Group):
    """Commands imported when they are called: the node must not wait for plotting libraries."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names in the order of work."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return a command."""
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(f"hgma_compensation.cli.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands from their table, without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(cls=LazyCommands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="hgma")
def hgma() -> None:
    """Remove the temperature drift of an accelerometer.

    Record an oven test (or make one with `hgma simulate`, or `hgma import-csv` it), then `hgma train` a
    calibration, judge it with `hgma evaluate`, and run it with `hgma node`.
    """


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 when done and 2 when the input is refused."""
    try:
        result = hgma.main(arguments, prog_name="hgma", standalone_mode=False)
    except RefusedError as refusal:
        return _refuse(str(refusal))
    except click.exceptions.NoArgsIsHelpError as request:
        click.echo(request.format_message())
        return 0
    except click.ClickException as error:
        hint = f" (see {error.ctx.command_path} --help)" if isinstance(error, click.UsageError) and error.ctx else ""
        return _refuse(" ".join(error.format_message().split()) + hint)
    except (KeyboardInterrupt, click.Abort):
        click.echo("interrupted, nothing was written", err=True)
        return INTERRUPTED
    return result if isinstance(result, int) else 0


def _refuse(reason: str) -> int:
    click.echo(f"error: {reason}", err=True)
    return REFUSED


if __name__ == "__main__":
    sys.exit(main())
