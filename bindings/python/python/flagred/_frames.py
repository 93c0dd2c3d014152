"""Frames of other libraries: the result for a frame is a frame of the same library."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from .errors import DataError

if TYPE_CHECKING:
    from ._core import RuleSet


def _library(value: Any) -> str:
    return type(value).__module__.partition(".")[0].lstrip("_")


def is_frame(value: Any) -> bool:
    """Whether a value contains a column for each input, and is not a column itself."""
    if _is_pandas(value):
        return True
    if hasattr(value, "__arrow_c_stream__") or hasattr(value, "__arrow_c_array__"):
        return any(hasattr(value, name) for name in ("schema", "columns", "column_names")) or not any(
            hasattr(value, name) for name in ("dtype", "type", "__array__")
        )
    return _library(value) == "polars" and hasattr(value, "collect")


def _is_pandas(value: Any) -> bool:
    return "pandas" in sys.modules and isinstance(value, sys.modules["pandas"].DataFrame)


def evaluate(rule_set: RuleSet, frame: Any, threads: int | None, with_reasons: bool) -> Any:
    """Evaluates a frame, and returns a frame of the same library."""
    if _is_pandas(frame):
        return _pandas(rule_set, frame, threads, with_reasons)
    library = _library(frame)
    if library == "polars" and hasattr(frame, "collect"):
        raise DataError("a lazy frame has no rows yet\n  help: collect it first: `model(frame.collect())`")
    table = rule_set._table(frame, threads, with_reasons)
    if library == "polars":
        import polars

        return polars.DataFrame(table)
    if library == "pyarrow":
        import pyarrow

        made = pyarrow.table(table)
        if isinstance(frame, pyarrow.RecordBatch):
            return made.combine_chunks().to_batches()[0] if len(made) else pyarrow.RecordBatch.from_pylist([], made.schema)
        return made
    if library in ("duckdb", "_duckdb"):
        import duckdb
        import pyarrow

        return duckdb.from_arrow(pyarrow.table(table))
    return table


def explain(rule_set: RuleSet, frame: Any) -> Any:
    """The explanation of each row of a frame, as a frame of the same library with a row for each contributing rule."""
    import numpy as np

    from ._arrays import array
    from ._tables import column_of, table_of

    library = _library(frame)
    data = table_of(frame)
    columns = [array(column_of(data, name)) for name in rule_set._input_names()]
    found: dict[str, Any] = rule_set._explain_rows(columns)
    found["output"] = np.asarray(rule_set._output_names(), dtype=object)[found["output"]]
    if _is_pandas(frame):
        import pandas

        found["row"] = frame.index.take(found["row"])
        return pandas.DataFrame(found)
    if library == "polars":
        import polars

        return polars.DataFrame({**found, "output": found["output"].tolist()}, schema_overrides={"output": polars.String})
    if library in ("pyarrow", "duckdb", "_duckdb"):
        import pyarrow

        made = pyarrow.table({**found, "output": pyarrow.array(found["output"].tolist(), pyarrow.string())})
        if library == "pyarrow":
            return made
        import duckdb

        return duckdb.from_arrow(made)
    return found


def _pandas(rule_set: RuleSet, frame: Any, threads: int | None, with_reasons: bool) -> Any:
    """Uses NumPy columns, which does not require pyarrow and does not copy float64."""
    import numpy as np
    import pandas

    columns = []
    for name in rule_set._input_names():
        if name not in frame.columns:
            there = ", ".join(f"`{column}`" for column in frame.columns)
            raise DataError(f"the frame has no column `{name}`\n  help: its columns are {there}")
        columns.append(frame[name])
        if columns[-1].ndim != 1:
            raise DataError(f"the frame has the column `{name}` more than once\n  help: rename all of them except one")
    outputs = rule_set._output_names()
    found = (rule_set.evaluate if with_reasons else rule_set)(*columns, threads=threads)
    if len(outputs) == 1:
        found = {outputs[0]: found}
    if not with_reasons:
        return pandas.DataFrame(found, index=frame.index)
    made: dict[str, Any] = {}
    with_ends = rule_set._interval_names()
    for name, outcomes in found.items():
        prefix = "" if len(outputs) == 1 else f"{name}_"
        rules = outcomes.dominant_rule
        made[name] = outcomes.value
        if name in with_ends:
            made[f"{name}_low"] = outcomes.low
            made[f"{name}_high"] = outcomes.high
        made[f"{prefix}coverage"] = outcomes.coverage
        made[f"{prefix}dominant_rule"] = pandas.arrays.IntegerArray(
            np.ma.getdata(rules), np.ma.getmaskarray(rules).copy()
        )
        made[f"{prefix}clamped"] = outcomes.clamped
    return pandas.DataFrame(made, index=frame.index)
