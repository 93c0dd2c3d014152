"""Tables of any library: columns by their names."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import DataError


# Options that are counts.
_WHOLE = {
    "clusters", "digits", "folds", "iterations", "max_inputs", "max_rules", "max_terms", "min_support", "seed", "starts"
}  # fmt: skip


def names_of(names: Iterable[str]) -> list[str]:
    """A list of names; a single name becomes a list of one."""
    return [names] if isinstance(names, str) else list(names)


def whole_numbers(options: dict[str, Any]) -> dict[str, Any]:
    """Returns the options unchanged. Raises an error if a count is not a whole number of at least 0."""
    for key in sorted(_WHOLE & options.keys()):
        value = options[key]
        if value is not None and (isinstance(value, bool) or not isinstance(value, Integral) or value < 0):
            raise DataError(f"`{key}` is {value!r}; it must be a whole number of at least 0")
    return options


def table_of(data: Any) -> Any:
    """An object that returns columns by their names."""
    if hasattr(data, "fetchnumpy"):
        return data.fetchnumpy()
    if hasattr(data, "collect"):
        raise DataError("a lazy frame has no rows yet\n  help: collect it first: `frame.collect()`")
    return data


def column_names(data: Any) -> list[str]:
    """The names of the columns."""
    if hasattr(data, "schema") and hasattr(data.schema, "names") and not callable(data.schema.names):
        return [str(name) for name in data.schema.names]
    if isinstance(getattr(data, "columns", None), Iterable):
        return [str(name) for name in data.columns]
    if hasattr(data, "keys"):
        return [str(name) for name in data.keys()]
    raise DataError(f"`{type(data).__name__}` is not a table\n  help: pass a frame, or a dict of columns by their names")


def column_of(data: Any, name: str) -> Any:
    """The column with this name."""
    there = column_names(data)
    if name not in there:
        listed = ", ".join(f"`{column}`" for column in there)
        raise DataError(f"the data have no column `{name}`\n  help: {f'the columns are {listed}' if there else 'they have no columns'}")
    if there.count(name) > 1:
        raise DataError(f"the data have the column `{name}` more than once\n  help: rename all of them except one")
    return data[name]


def groups_of(data: Any, name: str) -> NDArray[np.uint32]:
    """An integer for each distinct value of a column."""
    return np.unique(np.asarray(column_of(data, name)).astype(str), return_inverse=True)[1].astype(np.uint32)


def same_length(columns: list[NDArray[Any]]) -> None:
    """Refuses columns of different lengths."""
    if any(column.ndim != 1 for column in columns):
        raise DataError("a column has no rows, or several columns have the same name")
    lengths = sorted({len(column) for column in columns})
    if len(lengths) > 1:
        raise DataError(f"the columns have different lengths: {', '.join(map(str, lengths))}")
