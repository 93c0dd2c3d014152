"""The command `flagred` that the wheel installs."""

import importlib.metadata
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import sysconfig
import time

import pytest

import flagred
from conftest import ROOT

COMMAND = os.path.join(sysconfig.get_path("scripts"), "flagred")
FLIGHT = str(ROOT / "examples/flights/steady.BIN")
# The program of crates/cli, whose output must be the same.
PROGRAM = os.environ.get("FLAGRED_COMMAND")


def run(*arguments: str, program: str = COMMAND, **more) -> subprocess.CompletedProcess:
    return subprocess.run([program, *arguments], capture_output=True, text=True, encoding="utf-8", timeout=120, **more)


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["assess", FLIGHT], 0),
        (["assess", "--fail-on", "good", FLIGHT], 2),
        (["check", "missing.yaml"], 3),
        (["check", str(ROOT / "rules/tipper.yaml")], 0),
        (["check", "--deny", "warnings", str(ROOT / "rules/flagred-paper.yaml")], 1),
        (["frobnicate"], 2),
        (["--help"], 0),
        ([], 2),
        (["help", "assess"], 0),
        (["explain", str(ROOT / "rules/tipper.yaml"), "service=8", "food=9"], 0),
    ],
)
def test_the_command_prints_and_returns_the_same_as_the_program(arguments, code):
    ours = run(*arguments)
    assert ours.returncode == code, ours.stderr
    assert "Traceback" not in ours.stderr
    if PROGRAM:
        theirs = run(*arguments, program=PROGRAM)
        assert (ours.returncode, ours.stdout, ours.stderr) == (theirs.returncode, theirs.stdout, theirs.stderr)


@pytest.mark.skipif(sys.platform != "linux", reason="names are Unicode here")
def test_names_that_are_not_unicode_reach_the_command(tmp_path):
    folder = os.fsencode(tmp_path) + b"/\xff"
    assert subprocess.run([COMMAND, "man", "--folder", folder], timeout=120).returncode == 0
    assert b"flagred-assess.1" in os.listdir(folder)


def test_the_command_starts_without_numpy_and_fast():
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        shown = run("--version")
        seconds.append(time.perf_counter() - start)
    assert shown.stdout == f"flagred {flagred.__version__}\n"
    print(f"flagred --version: {min(seconds) * 1000:.0f} ms")
    if "FLAGRED_TIMED" in os.environ:
        assert min(seconds) < 0.150, seconds
    imported = "import sys, _flagred_command; sys.argv = ['flagred', '--version']; _flagred_command.main(); print(*sys.modules)"
    modules = run("-c", imported, program=sys.executable).stdout.splitlines()[-1].split()
    assert "_flagred_command" in modules and "numpy" not in modules and "flagred" not in modules


@pytest.mark.skipif(os.name != "posix", reason="signals of Unix")
def test_ctrl_c_ends_a_watch():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    watch = subprocess.Popen([COMMAND, "watch", f"udpin:127.0.0.1:{port}"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert watch.stdout is not None
    assert f"127.0.0.1:{port}" in watch.stdout.readline()
    watch.send_signal(signal.SIGINT)
    _, err = watch.communicate(timeout=20)
    # Exit code 3, since no vehicle was received.
    assert (watch.returncode, err) == (3, "")


@pytest.mark.skipif(os.name != "posix", reason="signals of Unix")
def test_ctrl_c_ends_commands_that_handle_no_signals():
    # Blocks on its standard input.
    waiting = subprocess.Popen([COMMAND, "assess", "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(1)
    waiting.send_signal(signal.SIGINT)
    assert waiting.stdin is not None
    assert waiting.wait(timeout=20) == -signal.SIGINT
    assert waiting.stderr is not None and waiting.stderr.read() == ""


@pytest.mark.skipif(os.name != "posix", reason="pipes of Unix")
def test_a_closed_pipe_changes_nothing_and_prints_nothing():
    rows = subprocess.Popen([COMMAND, "assess", "--csv", FLIGHT], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert rows.stdout is not None and rows.stderr is not None
    rows.stdout.read(10)
    rows.stdout.close()
    assert rows.wait(timeout=60) == 0
    assert b"Traceback" not in rows.stderr.read()


def test_a_long_output_arrives_whole():
    schema = run("schema", "rule-set").stdout
    assert schema.rstrip().endswith("}")


def test_manual_pages_and_completions():
    files = importlib.metadata.files("flagred") or []
    shared = {re.sub(r".*share/", "", str(file)) for file in files if "share/" in str(file)}
    if not shared:
        pytest.skip("this wheel was not built by scripts/wheel")
    assert {"man/man1/flagred.1", "man/man1/flagred-assess.1", "bash-completion/completions/flagred"} <= shared
    assert {"zsh/site-functions/_flagred", "fish/vendor_completions.d/flagred.fish"} <= shared
    page = pathlib.Path(sysconfig.get_path("data"), "share/man/man1/flagred-assess.1").read_text(encoding="utf-8")
    assert page == run("man", "assess").stdout
