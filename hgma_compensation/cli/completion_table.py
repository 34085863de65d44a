"""What the shell completes of each command, remembered in a file: importing the commands takes a second.

The file lies in the user's cache folder, under a name that is derived from the sources of the commands. It is made at
the first completion, or by ``hgma completion``; where it cannot be written, all is as right and slower.
"""

import hashlib
import json
import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import click

from hgma_compensation.cli.paths import KINDS
from hgma_compensation.errors import RefusedError
from hgma_compensation.files import write_atomically

LARGEST = 1 << 20
"""Bytes of the file that are read."""

Entry = dict[str, Any]
"""A parameter: what is needed to complete it."""


def remembered_command(name: str, commands: Mapping[str, str]) -> click.Command:
    """Return a command that can be completed but does nothing; commands: what each does, in a few words."""
    return click.Command(name, short_help=commands[name], params=[_parameter(entry) for entry in table(commands)[name]])


def table(commands: Collection[str]) -> Mapping[str, list[Entry]]:
    """Return the parameters of each command, out of the file where there is one."""
    path = cache_file(commands)
    try:
        with path.open("rb") as file:
            found = json.loads(file.read(LARGEST))
        if set(found) == set(commands):
            return dict(found)
    except (OSError, ValueError, TypeError):
        pass
    made = _made(commands)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for old in path.parent.glob("completion-*.json"):
            old.unlink(missing_ok=True)
        write_atomically(path, json.dumps(made).encode())
    except (OSError, RefusedError):
        pass  # a home that is not writable
    return made


def cache_file(commands: Collection[str]) -> Path:
    """Return the path of the file for these commands, as their sources are now."""
    state = [f"{path.name} {path.stat().st_mtime_ns}" for path in sorted(Path(__file__).parent.glob("*.py"))]
    key = hashlib.sha256("\n".join([click.__file__, str(Path(__file__)), *commands, *state]).encode()).hexdigest()[:16]
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(home) / "hgma_compensation" / f"completion-{key}.json"


def _made(commands: Collection[str]) -> dict[str, list[Entry]]:
    from hgma_compensation.cli.main import load

    return {name: [_entry(parameter) for parameter in load(name).params] for name in commands}


def _entry(parameter: click.Parameter) -> Entry:
    option = isinstance(parameter, click.Option)
    entry: Entry = {
        "name": parameter.name,
        "option": option,
        "opts": parameter.opts,
        "nargs": parameter.nargs,
        "multiple": parameter.multiple,
        "kind": getattr(parameter.type, "kind", None),
    }
    if isinstance(parameter, click.Option):
        entry |= {"is_flag": parameter.is_flag, "help": parameter.help}
    if isinstance(parameter.type, click.Choice):
        entry["choices"] = [str(choice) for choice in parameter.type.choices]
    return entry


def _parameter(entry: Entry) -> click.Parameter:
    kinds = {getattr(kind, "kind", None): kind for kind in KINDS}
    if "choices" in entry:
        value: click.ParamType | None = click.Choice(entry["choices"])
    else:
        value = kinds[entry["kind"]]() if entry["kind"] in kinds else None
    if not entry["option"]:
        return click.Argument([entry["name"]], type=value, nargs=entry["nargs"])
    names = [*entry["opts"], entry["name"]]
    if entry["is_flag"]:
        return click.Option(names, is_flag=True, help=entry["help"], multiple=entry["multiple"])
    return click.Option(names, type=value, nargs=entry["nargs"], multiple=entry["multiple"], help=entry["help"])
