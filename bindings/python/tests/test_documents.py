"""The Python code of the documents runs and prints the documented output."""

import doctest
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT

pytest.importorskip("polars", reason="polars is not installed")


def blocks(document: str, language: str) -> list[tuple[str, int]]:
    """The text of each block, and the line where it begins."""
    text = (ROOT / document).read_text(encoding="utf-8")
    found = re.finditer(rf"^```{language}\n(.*?)^```$", text, re.S | re.M)
    return [(block[1], text.count("\n", 0, block.start(1))) for block in found]


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the repository's files, in which documents may write."""
    for shared in ("examples", "rules"):
        os.symlink(ROOT / shared, tmp_path / shared)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("document", "least", "needs"), [("docs/python.md", 40, "sklearn"), ("README.md", 3, "sklearn"), ("docs/fleet.md", 8, "distributed")]
)
def test_the_code_of_a_document_runs_as_printed(desk, document, least, needs):
    pytest.importorskip(needs, reason=f"{needs} is not installed: `pip install flagred[sklearn,fleet]`")
    parts = blocks(document, "pycon")
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE, verbose=False)
    names: dict = {"__name__": "document"}
    said: list[str] = []
    for text, line in parts:
        test = doctest.DocTestParser().get_doctest(text, names, document, document, line)
        runner.run(test, out=said.append, clear_globs=False)
        names = test.globs
    assert runner.summarize(verbose=False).failed == 0, "".join(said)
    assert runner.tries >= least


def printed(program: str, python: str) -> str:
    """The output of a program, after comparing it with the comment after its last line."""
    done = subprocess.run([python, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == program.strip().rpartition("# ")[2]
    return done.stdout.strip()


def programs() -> dict[str, str]:
    texts = [text for text, _ in blocks("docs/from-scikit-fuzzy.md", "python")]
    return {text.partition("\n")[0].removeprefix("# with "): text for text in texts}


def test_the_program_compared_with_scikit_fuzzy():
    assert printed(programs()["flagred"], sys.executable) == "19.8578"


def test_the_program_of_scikit_fuzzy():
    python = os.environ.get("SCIKIT_FUZZY_PYTHON")
    if python is None or shutil.which(python) is None:
        pytest.skip("SCIKIT_FUZZY_PYTHON names no Python that has scikit-fuzzy")
    assert printed(programs()["scikit-fuzzy"], python) == "19.8476"
