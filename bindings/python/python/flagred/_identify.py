"""Identification of a rule set from rows only."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import array
from ._core import _identify
from .errors import DataError
from ._learning import Figure
from ._model import Model, _read
from ._tables import column_names, column_of, groups_of, names_of, same_length, table_of, whole_numbers

__all__ = ["IdentifyResult", "IdentifyStep", "IdentifyValidation", "identify"]


class IdentifyStep(NamedTuple):
    """A step of the search."""

    input: str
    """The input that is added, or gets another term."""
    terms: int
    """The number of its terms; for clusters, the number of clusters."""
    left_out: float
    """The root mean square cross-validation error, in the unit of the output."""


class IdentifyValidation(NamedTuple):
    """Root mean square errors on rows that were held out of the whole search."""

    folds: int
    without_value: int
    """Rows for which no rule fires; the mean of the other rows replaces the prediction."""
    identified: Figure
    linear: Figure
    """The error of a linear regression on all columns."""
    mean: Figure
    ratio: Figure
    """The error of the identified rule set divided by that of the linear regression."""


class IdentifyResult(NamedTuple):
    """A rule set identified from data."""

    model: Model
    steps: list[IdentifyStep]
    without_rows: int
    """The combinations of terms with too few rows; they have no rule."""
    validation: IdentifyValidation | None


def identify(
    data: Any,
    target: str,
    *,
    inputs: Iterable[str] = (),
    ignore: Iterable[str] = (),
    antecedents: Literal["partitions", "clusters"] = "partitions",
    consequents: Literal["constants", "lines"] = "constants",
    max_inputs: int = 4,
    max_terms: int = 5,
    max_rules: int = 25,
    min_gain: float = 0.02,
    min_support: int = 1,
    group_by: str | None = None,
    folds: int = 5,
    seed: int = 0,
    validation: bool = True,
    skip_bad_rows: bool = False,
) -> IdentifyResult:
    """Finds inputs, terms and rules for a column of a table. ``flagred identify`` does the same.

    docs/rules-from-data.md describes the search.

    Parameters
    ----------
    data
        A frame, or a mapping of columns.
    target
        The column with the output.
    inputs
        The columns to use; by default, useful columns are selected.
    ignore
        Columns to ignore. Columns without numbers are always ignored.
    antecedents
        A rule for each combination of the terms of ``partitions``, or for each of the ``clusters`` of rows.
    consequents
        The consequents of rules: ``constants``, or ``lines`` over the inputs.
    max_inputs, max_terms, max_rules
        The maximum numbers of inputs, terms of an input (2 to 5) and rules.
    min_gain
        The least relative gain in cross-validation error per step.
    min_support
        The minimum number of rows for a rule.
    group_by
        Hold out all rows with the same value of this column together.
    folds
        The number of folds.
    seed
        The random seed of the folds.
    validation
        Whether the whole search is cross-validated.
    skip_bad_rows
        Skip rows with an unknown value.

    Raises
    ------
    DataError
        A column is missing, a value is unknown, or no input is useful.

    Examples
    --------
    >>> import numpy as np
    >>> import flagred
    >>> width, length = np.meshgrid(np.arange(10.0), np.arange(10.0))
    >>> rows = {"width": width.ravel(), "length": length.ravel(), "area": (width * length).ravel()}
    >>> found = flagred.identify(rows, "area")
    >>> sorted(found.model.inputs)
    ['length', 'width']
    >>> found.validation.ratio.value < 0.5
    True
    """
    data = table_of(data)
    wanted, without = names_of(inputs), {target, group_by, *names_of(ignore)}
    names = wanted or [name for name in column_names(data) if name not in without]
    columns = {name: array(column_of(data, name)) if wanted else _numbers(column_of(data, name)) for name in names}
    known = {name: column for name, column in columns.items() if column is not None}
    truths = array(column_of(data, target))
    groups = None if group_by is None else groups_of(data, group_by)
    same_length([*known.values(), truths, *([] if groups is None else [groups])])
    if skip_bad_rows:
        good = np.isfinite([truths, *known.values()]).all(axis=0)
        known, truths = {name: column[good] for name, column in known.items()}, truths[good]
        groups = None if groups is None else groups[good]
    for name, column in {**known, target: truths}.items():
        if not np.isfinite(column).all():
            row = int(np.argmin(np.isfinite(column)))
            help_text = "leave such rows out with `skip_bad_rows=True`, or the column with `ignore`"
            raise DataError(f"column `{name}`, row {row}: the value is unknown\n  help: {help_text}")
    options = {
        "antecedents": antecedents,
        "consequents": consequents,
        "inputs": wanted,
        "max_inputs": max_inputs,
        "max_terms": max_terms,
        "max_rules": max_rules,
        "min_gain": min_gain,
        "min_support": min_support,
        "folds": folds,
        "seed": seed,
        "validation": validation,
    }
    found = _identify(list(known), target, list(known.values()), truths, groups, whole_numbers(options))
    worth = found["validation"]
    if worth is not None:
        figures = {name: Figure(*worth[name]) for name in ("identified", "linear", "mean", "ratio")}
        worth = IdentifyValidation(worth["folds"], worth["without_value"], **figures)
    steps = [IdentifyStep(*step) for step in found["steps"]]
    return IdentifyResult(_read(found["model"], "<model>"), steps, found["without_rows"], worth)


def _numbers(column: Any) -> NDArray[np.float64] | None:
    """The column as numbers; None if it contains other values."""
    try:
        return array(column)
    except DataError:
        return None
