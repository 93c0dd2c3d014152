"""Simplification of rule sets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from ._arrays import array
from ._core import _simplify
from .errors import DataError
from ._model import Model, _read
from ._tables import column_of, same_length, table_of, whole_numbers

__all__ = ["Difference", "SimplifyResult", "simplify"]


class Difference(NamedTuple):
    """The difference of an output at a point."""

    output: str
    before: float
    after: float
    inputs: dict[str, float]


class SimplifyResult(NamedTuple):
    """A simplified rule set with the same outputs."""

    model: Model
    rules: list[list[int]]
    """For each rule, the numbers of the original rules that it replaces, from 1."""
    dropped: list[int]
    """The numbers of original rules without effect, from 1."""
    inputs: list[str]
    """The inputs that no rule needs; the model no longer has them."""
    points: int
    """The number of points at which the outputs were compared."""
    difference: Difference | None
    """The largest difference at these points; None if there is no difference."""


def simplify(
    model: Model,
    data: Any = None,
    *,
    tolerance: float | None = None,
    rows_only: bool = False,
    seed: int = 0,
    columns: Mapping[str, str] | None = None,
) -> SimplifyResult:
    """Simplifies a rule set: fewer rules and inputs, same outputs. ``flagred simplify`` does the same.

    Parameters
    ----------
    model
        The rule set to start from. It does not change.
    data
        A frame, or a mapping of columns, with a column for each input: additional rows at which the outputs are compared.
    tolerance
        The maximum difference of an output, in its unit; by default 1e-12 of its range.
    rows_only
        Compare the outputs only at the rows. Elsewhere they may differ.
    seed
        The random seed of the points.
    columns
        The names of columns that differ from those of their inputs.

    Raises
    ------
    DataError
        A column is missing, there are no rows for ``rows_only``, or the tolerance is below 0.
    RuleSetError
        The rule set cannot be used.

    Examples
    --------
    >>> import flagred
    >>> fan = (
    ...     flagred.Model("fan")
    ...     .input("heat", range=(0, 40), partition=["cool", "warm", "hot"])
    ...     .output("speed", range=(0, 10), terms={"slow": {"singleton": 2}, "fast": {"singleton": 8}})
    ...     .rule("IF heat IS cool THEN speed IS slow")
    ...     .rule("IF heat IS warm THEN speed IS fast", "IF heat IS hot THEN speed IS fast")
    ... )
    >>> simplified = flagred.simplify(fan)
    >>> [rule.text for rule in simplified.model.rules]
    ['IF heat IS cool THEN speed IS slow', 'IF heat IS NOT cool THEN speed IS fast']
    >>> simplified.rules
    [[1], [2, 3]]
    """
    names = list(model._input_names())
    renamed = dict(columns or {})
    for name in renamed:
        if name not in names:
            raise DataError(f"`columns` names `{name}`, which is not an input of the rule set")
    rows = []
    if data is not None:
        data = table_of(data)
        rows = [array(column_of(data, renamed.get(name, name))) for name in names]
        same_length(rows)
    found = _simplify(
        model, rows, whole_numbers({"tolerance": tolerance, "rows_only": rows_only, "seed": seed})
    )
    difference = found.pop("difference")
    if difference is not None:
        output, before, after, inputs = difference
        difference = Difference(output, before, after, dict(zip(names, inputs)))
    return SimplifyResult(model=_read(found.pop("model"), "<model>"), difference=difference, **found)
