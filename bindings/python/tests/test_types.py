"""The types that type checkers infer."""

import os
import pathlib
import subprocess
import sys

import pytest

import flagred

pytest.importorskip("mypy", reason="mypy is not installed")

PROGRAM = """
from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import flagred
from flagred.types import Explanation, IntervalOutcome, Outcome, Outcomes


class Frame:
    @property
    def columns(self) -> list[str]:
        return []


model = flagred.load("flagred-paper")
array, frame = np.zeros(3), Frame()
assert_type(model(8, 9), float)
assert_type(model(8, None), float)
assert_type(model(margin=8, spread=9), float)
assert_type(model({"margin": 8, "spread": 9}), float)
assert_type(model(array, 9), NDArray[np.float64])
assert_type(model([1, 2], [3, 4]), NDArray[np.float64])
assert_type(model(frame), Frame)
assert_type(model.evaluate(8, 9), Outcome)
assert_type(model.evaluate(array, array), Outcomes)
assert_type(model.evaluate(frame), Frame)
assert_type(model.evaluate_interval(8, (9, 10)), IntervalOutcome)
assert_type(model.explain(8, 9), Explanation)
assert_type(model.explain(frame), Frame)
term = model.inputs["margin"]["low"]
assert_type(term(0.5), float)
assert_type(term(array), NDArray[np.float64])
"""


def test_overloads(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.replace("typing import assert_type", "typing_extensions import assert_type"))
    # If the package is not installed, mypy searches for it where Python found it.
    package = pathlib.Path(flagred.__file__).parent.parent
    environment = {**os.environ, **({} if package.name == "site-packages" else {"MYPYPATH": str(package)})}
    arguments = ["--strict", "--cache-dir", tmp_path / "cache", program]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *arguments], capture_output=True, text=True, cwd=tmp_path, env=environment, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
