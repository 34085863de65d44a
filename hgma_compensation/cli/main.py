"""``hgma``: its commands, and the one place where a mistake of the user becomes a line and exit code 2."""

import importlib
import sys
from collections.abc import Sequence

import click

from hgma_compensation import __version__
from hgma_compensation.cli import outputs
from hgma_compensation.errors import RefusedError

COMMANDS = {
    "simulate": "an oven test of the simulated high-g accelerometer",
    "import-csv": "a recording out of a table",
    "plan": "an oven programme for the effects wanted",
    "check": "what recordings can and cannot identify",
    "train": "recordings in, calibration out",
    "evaluate": "error of a recording before and after compensation",
    "diagnose": "name the effect that a calibration lacks, and add it",
    "fleet": "calibrate and judge many sensors, one for each folder",
    "compensate": "a recording with the compensated topics added",
    "play": "publish a recording to ROS",
    "inspect": "a calibration in words",
    "watch": "what a running node receives and publishes",
    "export": "cubic coefficients for PX4 or ArduPilot",
    "node": "run the ROS 2 node",
    "completion": "let the shell complete commands, options and files",
}
"""In the order of work; each in the module of its name, imported only when it is called."""

WITHOUT_JSON = {
    "node": "runs until it is stopped, its figures are on accel/state and /diagnostics",
    "completion": "prints a script of the shell, which holds no figures",
}
"""Commands without --json, and why; every other has it (test_cli_commands.py)."""

REFUSED = 2
INTERRUPTED = 130


class LazyCommands(click.Group):
    """Commands imported when they are called: the node must not wait for plotting libraries."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names in the order of work."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return a command; for the completion of the shell, what is remembered of it."""
        if cmd_name not in COMMANDS:
            return None
        if ctx.resilient_parsing:
            from hgma_compensation.cli.completion_table import remembered_command

            return remembered_command(cmd_name, COMMANDS)
        return load(cmd_name)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that the words call; one that does not exist is refused with the near ones."""
        name = args[0]
        if name in COMMANDS or name.startswith("-") or ctx.resilient_parsing:
            return super().resolve_command(ctx, args)
        from difflib import get_close_matches

        near = get_close_matches(name, COMMANDS, cutoff=0.5) or [one for one in COMMANDS if one.startswith(name[:3])]
        question = f"did you mean {' or '.join(near[:2])}?" if near else f"there are {', '.join(COMMANDS)}"
        raise click.UsageError(f"No such command '{name}': {question}", ctx)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands from their table, without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def load(name: str) -> click.Command:
    """Import and return a command of the table."""
    module = importlib.import_module(f"hgma_compensation.cli.{name.replace('-', '_')}")
    command: click.Command = module.command
    return command


@click.group(cls=LazyCommands, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="hgma")
@click.pass_context
def hgma(context: click.Context) -> None:
    """Remove the temperature drift of an accelerometer.

    Record an oven test (or make one with `hgma simulate`, or `hgma import-csv` it), then `hgma train` a
    calibration, judge it with `hgma evaluate`, and run it with `hgma node`. `hgma` alone says what to do
    next with what lies in the present folder.
    """
    if context.invoked_subcommand is None:
        from hgma_compensation.cli.start import show_next_steps

        show_next_steps(COMMANDS)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 when done, 2 when the input is refused and 130 when it is interrupted."""
    outputs.begin()
    try:
        result = hgma.main(arguments, prog_name="hgma", standalone_mode=False)
    except RefusedError as refusal:
        return _refuse(str(refusal))
    except click.exceptions.NoArgsIsHelpError as request:
        click.echo(request.format_message())
        return 0
    except click.ClickException as error:
        return _refuse(_explained(error))
    except (KeyboardInterrupt, click.Abort):
        written = ", ".join(map(str, outputs.written()))
        click.echo(
            f"interrupted, {written} was written before" if written else "interrupted, nothing was written", err=True
        )
        return INTERRUPTED
    except OSError as error:  # of the machine, such as a full disk
        place = f" {error.filename}:" if error.filename else ""
        return _refuse(f"{place.lstrip()} {error.strerror or error}: check the disk and the permissions".strip())
    except MemoryError:
        return _refuse("there is not enough memory for this recording: use a part of it, with --from and --until")
    return result if isinstance(result, int) else 0


def _explained(error: click.ClickException) -> str:
    """Return what click says, with the remedy."""
    text = " ".join(error.format_message().split()).removesuffix(".")
    if isinstance(error, click.MissingParameter) and isinstance(error.param, click.Option):
        text += f": add {error.param.opts[0]} {error.param.metavar or ''}".rstrip()
        text += f" ({error.param.help.rstrip('.')})" if error.param.help else ""
    return text + (
        f" (see {error.ctx.command_path} --help)" if isinstance(error, click.UsageError) and error.ctx else ""
    )


def _refuse(reason: str) -> int:
    click.echo(f"error: {RefusedError(reason)}", err=True)
    return REFUSED


if __name__ == "__main__":
    sys.exit(main())
