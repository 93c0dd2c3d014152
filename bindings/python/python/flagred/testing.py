"""Snapshots of rule sets, for tests.

A snapshot is a table of points and outputs, as written by ``flagred map --csv`` and ``flagred eval``. It belongs in the
repository, beside the rule set.
"""

from __future__ import annotations

import csv
import math
import os
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .errors import DataError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._model import Model

__all__ = ["assert_map"]

_NEGLIGIBLE = 1e-9
_MOST_POINTS = 100_000
_UPDATE = "FLAGRED_UPDATE"


def assert_map(model: Model, path: str | os.PathLike[str], *, points: int = 11) -> None:
    """Asserts that the outputs of a rule set equal those of a snapshot.

    With the environment variable ``FLAGRED_UPDATE=1`` it writes the snapshot.

    Parameters
    ----------
    model
        The rule set.
    path
        The snapshot: a CSV with a column for each input and for at least one output. Other columns are ignored.
    points
        The points along each input of a snapshot to write.

    Raises
    ------
    AssertionError
        A value differs, or there is no such file. The message contains the largest difference and its point.
    DataError
        The file is not such a table, or the snapshot would have more than 100,000 points.

    Examples
    --------
    In a test of pytest:

    >>> import flagred
    >>> from flagred.testing import assert_map
    >>> def test_fan() -> None:
    ...     assert_map(flagred.load("fan.yaml"), "fan.map.csv")
    """
    if os.environ.get(_UPDATE, "") not in ("", "0"):
        _write(model, Path(path), points)
        return
    if not Path(path).exists():
        raise AssertionError(f"there is no snapshot `{path}`: run the test once with {_UPDATE}=1, which writes it")
    columns = _columns(Path(path))
    inputs = [_column(columns, name, path) for name in model.inputs]
    names = [name for name in model.outputs if name in columns]
    if not names:
        raise DataError(f"`{path}` has no column for an output: {', '.join(model.outputs)}")
    now = _evaluate(model, inputs)
    for name in names:
        _compare(model, str(path), name, inputs, columns[name], now[name])


def _compare(
    model: Model,
    path: str,
    name: str,
    inputs: list[NDArray[np.float64]],
    before: NDArray[np.float64],
    now: NDArray[np.float64],
) -> None:
    low, high = model.outputs[name].range
    difference = np.abs(before - now)
    difference[np.isnan(before) & np.isnan(now)] = 0.0
    difference[np.isnan(before) != np.isnan(now)] = math.inf
    differs = difference > _NEGLIGIBLE * (high - low)
    if not differs.any():
        return
    row = int(difference.argmax())
    at = ", ".join(f"{name} = {values[row]:g}" for name, values in zip(model.inputs, inputs, strict=True))
    raise AssertionError(
        f"{path}: `{name}` differs at {int(differs.sum())} of {len(now)} points, "
        f"most in row {row + 1}, at {at}: {_shown(before[row])} before, {_shown(now[row])} now\n"
        f"  help: if the change is intended, run the test with {_UPDATE}=1 and commit the file"
    )


def _shown(value: float) -> str:
    return "no value" if math.isnan(value) else f"{value:.6g}"


def _evaluate(model: Model, inputs: list[NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    found = model(*inputs)
    return found if isinstance(found, dict) else {next(iter(model.outputs)): found}


def _columns(path: Path) -> dict[str, NDArray[np.float64]]:
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if len(rows) < 2:
        raise DataError(f"`{path}` has no rows")
    header, body = rows[0], rows[1:]
    for i, row in enumerate(body):
        if len(row) != len(header):
            raise DataError(f"`{path}`, row {i + 1}: {len(row)} cells, but the header has {len(header)}")
    return {name: np.array([_number(row[i]) for row in body]) for i, name in enumerate(header)}


def _column(columns: dict[str, NDArray[np.float64]], name: str, path: str | os.PathLike[str]) -> NDArray[np.float64]:
    if name not in columns:
        raise DataError(f"`{path}` has no column `{name}`")
    return columns[name]


def _number(cell: str) -> float:
    # Columns that are not compared may contain text.
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _write(model: Model, path: Path, points: int) -> None:
    if points < 2 or points ** len(model.inputs) > _MOST_POINTS:
        raise DataError(
            f"{points} points along each of {len(model.inputs)} inputs are not a valid snapshot\n"
            f"  help: choose from 2 points to {_MOST_POINTS:,} in all, or write it with `flagred map --csv --sample 1000`"
        )
    ends = [variable.range for variable in model.inputs.values()]
    axes = [np.linspace(low, high, points).tolist() for low, high in ends]
    grid = np.array(list(product(*axes)))
    inputs = [np.ascontiguousarray(column) for column in grid.T]
    outputs = _evaluate(model, inputs)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*model.inputs, *outputs])
        for row in zip(*inputs, *outputs.values(), strict=True):
            writer.writerow(["" if math.isnan(value) else repr(float(value)) for value in row])
