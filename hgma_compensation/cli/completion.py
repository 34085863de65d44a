"""``hgma completion``."""

import click
from click.shell_completion import get_completion_class

SHELLS = {
    "bash": ('eval "$(hgma completion bash)"', "~/.bashrc"),
    "zsh": ('eval "$(hgma completion zsh)"', "~/.zshrc, after compinit"),
    "fish": ("hgma completion fish | source", "~/.config/fish/config.fish"),
}
"""The line that turns the completion on, and the file it belongs into."""

VARIABLE = "_HGMA_COMPLETE"


@click.command("completion", epilog="Example: hgma completion bash")
@click.argument("shell", type=click.Choice(list(SHELLS)))
def command(shell: str) -> None:
    """Print the script that lets a shell complete commands, options, channels and files.

    The script's last lines say which line to put into which file. Where hgma lives in a virtual environment, that
    line comes after the one that activates it.
    """
    from hgma_compensation.cli.completion_table import table
    from hgma_compensation.cli.main import COMMANDS, hgma

    line, place = SHELLS[shell]
    found = get_completion_class(shell)
    if found is None:
        raise click.UsageError(f"click knows no completion of {shell}: install a newer click")
    table(COMMANDS)  # so that the first completion is as quick as the others
    click.echo(found(hgma, {}, "hgma", VARIABLE).source())
    click.echo(f"# To have this in every shell, put this line into {place}:\n#     {line}")
