"""Snapshots of rule sets, for tests.

A snapshot is a table of points and outputs, as written by ``flagred map --csv`` and ``flagred eval``. It belongs in the
repository, beside the rule set.
"""

from __future__ import annotations

import csv
import math
import os
from dataclasses import dataclass
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
# The columns of `flagred map --csv` that describe the outputs.
_DERIVED = ("coverage", "dominant_rule", "filled", "distance")


def assert_map(model: Model, path: str | os.PathLike[str], *, points: int = 11, suffix: str = "") -> None:
    """Asserts that the outputs of a rule set equal those of a snapshot.

    With the environment variable ``FLAGRED_UPDATE=1`` it writes the snapshot: the outputs at the points of the file, or at a
    grid of points if there is no file. The columns ``coverage``, ``dominant_rule``, ``filled`` and ``distance`` of ``flagred
    map`` are removed, since they would be out of date; all other cells are kept.

    Parameters
    ----------
    model
        The rule set.
    path
        The snapshot: a CSV with a column for each input and for at least one output. Other columns are ignored.
    points
        The points along each input of a new snapshot.
    suffix
        The suffix of the columns of the outputs, as of ``flagred eval --suffix``.

    Raises
    ------
    AssertionError
        A value differs, or there is no such file. The message contains the largest difference and its point.
    DataError
        The file is not such a table, or a new snapshot would have more than 100,000 points.

    Examples
    --------
    In a test of pytest:

    >>> import flagred
    >>> from flagred.testing import assert_map
    >>> def test_fan() -> None:
    ...     assert_map(flagred.load("fan.yaml"), "fan.map.csv")
    """
    path, is_update = Path(path), os.environ.get(_UPDATE, "") not in ("", "0")
    if not path.exists():
        if not is_update:
            raise AssertionError(f"there is no snapshot `{path}`: run the test once with {_UPDATE}=1, which writes it")
        _write_grid(model, path, points, suffix)
        return
    table = _read(path)
    inputs = [table.numbers(name) for name in model.inputs]
    columns = {f"{name}{suffix}": name for name in model.outputs}
    found = {column: name for column, name in columns.items() if column in table.header}
    if not found:
        raise DataError(f"`{path}` has no column for an output: {', '.join(columns)}")
    now = _evaluate(model, inputs)
    if is_update:
        _update(table, model, {column: now[name] for column, name in found.items()})
        return
    for column, name in found.items():
        _compare(model, table, (name, column), inputs, now[name])


@dataclass
class _Table:
    path: Path
    header: list[str]
    rows: list[list[str]]
    # The line of the file in which each row ends.
    lines: list[int]

    def numbers(self, name: str) -> NDArray[np.float64]:
        if name not in self.header:
            raise DataError(f"`{self.path}` has no column `{name}`")
        column = self.header.index(name)
        return np.array([_number(row[column]) for row in self.rows])


def _compare(
    model: Model,
    table: _Table,
    output: tuple[str, str],
    inputs: list[NDArray[np.float64]],
    now: NDArray[np.float64],
) -> None:
    name, column = output
    before = table.numbers(column)
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
        f"{table.path}: `{column}` differs at {int(differs.sum())} of {len(now)} points, "
        f"most in line {table.lines[row]}, at {at}: {_shown(before[row])} before, {_shown(now[row])} now\n"
        f"  help: if the change is intended, run the test with {_UPDATE}=1 and commit the file"
    )


def _shown(value: float) -> str:
    return "no value" if math.isnan(value) else f"{value:.6g}"


def _evaluate(model: Model, inputs: list[NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    found = model(*inputs)
    return found if isinstance(found, dict) else {next(iter(model.outputs)): found}


def _read(path: Path) -> _Table:
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        rows = [(reader.line_num, row) for row in reader if row]
    if len(rows) < 2:
        raise DataError(f"`{path}` has no rows")
    header, body = rows[0][1], rows[1:]
    for line, row in body:
        if len(row) != len(header):
            raise DataError(f"`{path}`, line {line}: {len(row)} cells, but the header has {len(header)}")
    return _Table(path, header, [row for _, row in body], [line for line, _ in body])


def _number(cell: str) -> float:
    # An unknown value is an empty cell or a word such as NA.
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _update(table: _Table, model: Model, now: dict[str, NDArray[np.float64]]) -> None:
    known = {*model.inputs, *model.outputs}
    kept = [name for name in table.header if name in known or name not in _DERIVED]
    rows = []
    for i, row in enumerate(table.rows):
        cells = dict(zip(table.header, row, strict=True))
        cells.update({name: _cell(values[i]) for name, values in now.items()})
        rows.append([cells[name] for name in kept])
    _write(table.path, kept, rows)


def _write_grid(model: Model, path: Path, points: int, suffix: str) -> None:
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
    rows = [[_cell(value) for value in row] for row in zip(*inputs, *outputs.values(), strict=True)]
    _write(path, [*model.inputs, *(f"{name}{suffix}" for name in outputs)], rows)


def _cell(value: float) -> str:
    return "" if math.isnan(value) else repr(float(value))


def _write(path: Path, header: list[str], rows: list[list[str]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
