import json
import os
import pty
import select
import subprocess
import sys
import time

import pytest
from builders import make_calibration, make_recording
from test_cli import run

from hgma_compensation.calibration.document import write_calibration
from hgma_compensation.channels import CHANNELS
from hgma_compensation.cli import completion_table
from hgma_compensation.cli.completion import SHELLS
from hgma_compensation.cli.main import COMMANDS, load
from hgma_compensation.recording.bag_writer import write_recording

HEAVY = {"numpy", "scipy", "rclpy", "rosbags", "matplotlib", "pymoo", "yaml", "rich"}
PROGRAM = """
import json, sys
from hgma_compensation.cli.main import main
try:
    main()
finally:
    print(json.dumps(sorted({name.split(".")[0] for name in sys.modules})), file=sys.stderr)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("completion")
    (folder / "bags").mkdir()
    for bag in (folder / "oven", folder / "bags" / "cold"):
        write_recording(make_recording(duration_s=30.0), bag)
    write_calibration(make_calibration(), folder / "cal.json")
    (folder / "diagnosis").mkdir()
    write_calibration(make_calibration(), folder / "diagnosis" / "calibration.json")
    (folder / "settings.json").write_text("{}")
    (folder / "table.csv").write_text("t,T,az\n0,20,9.8\n")
    (folder / "scenario.yaml").write_text("scenario: 1\n")
    (folder / "other.yaml").write_text("a: 1\n")
    (folder / "a name.csv").write_text("t,T,az\n0,20,9.8\n")
    return folder


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory):
    """Keep the table out of the home folder."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def complete(folder, monkeypatch, capfd, line, shell="bash"):
    """Return what the shell is told for a line that ends at the cursor."""
    words = line.split(" ")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("_HGMA_COMPLETE", f"{shell}_complete")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", words[-1] if shell == "fish" else str(len(words) - 1))
    with pytest.raises(SystemExit) as end:
        run()
    assert end.value.code == 0
    return capfd.readouterr().out


@pytest.mark.parametrize(
    ("line", "values"),
    [
        ("hgma ev", ["evaluate"]),
        ("hgma com", ["compensate", "completion"]),
        ("hgma evaluate --cal", ["--calibration"]),
        ("hgma evaluate oven --calibration c", ["cal.json"]),
        ("hgma evaluate oven --calibration ", ["cal.json", "diagnosis/calibration.json"]),
        ("hgma inspect diagnosis/", ["diagnosis/calibration.json"]),
        ("hgma inspect ./c", ["./cal.json"]),
        ("hgma evaluate ", ["bags/cold", "oven"]),
        ("hgma train oven b", ["bags/cold"]),
        ("hgma diagnose oven --holdout b", ["bags/cold"]),
        ("hgma import-csv ta", ["table.csv"]),
        ("hgma import-csv table.csv --time-unit ", ["s", "ms", "us", "ns"]),
        ("hgma simulate ", ["scenario.yaml"]),
        ("hgma train oven --method poly", ["polynomial", "polynomial-rate"]),
        ("hgma train oven --channels linear_acceleration.z,angular_velocity.", [
            f"linear_acceleration.z,{channel}" for channel in CHANNELS[3:]
        ]),
        ("hgma completion ", list(SHELLS)),
    ],
)  # fmt: skip
def test_what_fits_is_offered(folder, monkeypatch, capfd, line, values):
    told = complete(folder, monkeypatch, capfd, line).split()
    assert sorted(told) == sorted(f"plain,{value}" for value in values)


def test_where_nothing_fits_the_shell_looks_for_itself(folder, monkeypatch, capfd):
    for line in ("hgma evaluate nothing", "hgma evaluate oven --plot x", "hgma import-csv a"):
        assert complete(folder, monkeypatch, capfd, line).startswith("file,")


@pytest.mark.parametrize("shell", SHELLS)
def test_every_shell_is_told(folder, monkeypatch, capfd, shell):
    told = complete(folder, monkeypatch, capfd, "hgma ev", shell)
    assert "evaluate" in told
    assert shell == "bash" or COMMANDS["evaluate"] in told


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_says_where_it_belongs(shell, capfd):
    assert run("completion", shell) == 0
    script = capfd.readouterr().out
    assert f"_HGMA_COMPLETE={shell}_complete" in script
    assert all(part in script for part in SHELLS[shell])
    assert f"#     {SHELLS[shell][0]}" in script.splitlines()


def test_completing_imports_nothing_heavy(folder):
    environment = {**os.environ, "_HGMA_COMPLETE": "bash_complete"}
    lines = ("hgma ev", "hgma train --ch", "hgma evaluate o", "hgma inspect ")
    completion_table.table(COMMANDS)
    for line in lines:
        environment |= {"COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1)}
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], cwd=folder, env=environment, capture_output=True, text=True, check=True
        )
        assert "plain," in done.stdout
        assert not set(json.loads(done.stderr)) & HEAVY


@pytest.mark.parametrize("command", COMMANDS)
def test_what_is_remembered_is_the_command(command):
    real, remembered = load(command), completion_table.remembered_command(command, COMMANDS)
    for one, other in zip(real.params, remembered.params, strict=True):
        assert (one.name, one.opts, one.nargs, one.multiple) == (other.name, other.opts, other.nargs, other.multiple)
        assert getattr(one, "is_flag", False) == getattr(other, "is_flag", False)
        assert getattr(one.type, "kind", None) in (None, getattr(other.type, "kind", None))
        assert getattr(one.type, "choices", None) in (None, getattr(other.type, "choices", None)) or (
            list(map(str, one.type.choices)) == list(other.type.choices)
        )


def test_a_damaged_or_missing_memory_is_made_anew(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    good = completion_table.table(COMMANDS)
    path = completion_table.cache_file(COMMANDS)
    for damage in (b"", b"{", b"[1]", b"null", b'{"train": []}', b"\xff"):
        path.write_bytes(damage)
        assert completion_table.table(COMMANDS) == good
        assert json.loads(path.read_text()) == good
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/nowhere")
    assert completion_table.table(COMMANDS) == good


def test_another_source_has_another_memory(tmp_path, monkeypatch):
    before = completion_table.cache_file(COMMANDS)
    assert completion_table.cache_file([*COMMANDS, "new"]) != before


def test_in_a_real_bash(folder, tmp_path):
    """Type into an interactive bash with Tab, and see what the command is given."""
    program = tmp_path / "bin" / "hgma"
    program.parent.mkdir()
    code = f'exec "{sys.executable}" -m hgma_compensation.cli.main "$@"'
    program.write_text(
        f'#!/bin/bash\n[ -n "$_HGMA_COMPLETE" ] || [ "$1" = completion ] || {{ echo "GIVEN:$*:"; exit; }}\n{code}\n'
    )
    program.chmod(0o755)
    environment = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}", "TERM": "dumb", "PS1": "ready> "}
    master, slave = pty.openpty()
    bash = subprocess.Popen(
        ["bash", "--norc", "--noprofile", "-i"], stdin=slave, stdout=slave, stderr=slave, cwd=folder, env=environment,
        start_new_session=True,
    )  # fmt: skip
    os.close(slave)
    seen = ""

    def until(text):
        nonlocal seen
        end = time.monotonic() + 60.0
        while text not in seen:
            assert time.monotonic() < end, seen
            if select.select([master], [], [], 0.1)[0]:
                seen += os.read(master, 4096).decode(errors="replace")
        seen = seen.partition(text)[2]

    def type_in(text):
        os.write(master, text.encode())

    try:
        type_in('eval "$(hgma completion bash)"; echo sour""ced\n')
        until("sourced")
        for typed, completed in (
            ("hgma ev\t", "aluate "),
            ("o\t", "ven "),
            ("--cali\t", "bration "),
            ("c\t", "al.json "),
        ):
            type_in(typed)
            until(completed)
        type_in("\n")
        until("GIVEN:evaluate oven --calibration cal.json:")
    finally:
        bash.kill()
        bash.wait()
        os.close(master)
