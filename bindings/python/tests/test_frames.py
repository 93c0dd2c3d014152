"""Frames of other libraries: columns by name in, the same kind of frame out."""

import importlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import flagred
from conftest import GAPS, KEEPS, TIP

MODEL = flagred.loads(TIP)
SERVICE = [8.0, None, 3.0, 11.0, float("nan")]
FOOD = [9.0, 9.0, 1.0, -1.0, 4.0]
EXPECTED = MODEL([8, np.nan, 3, 11, np.nan], FOOD)


def library(name):
    return pytest.importorskip(name)


def test_pandas():
    pandas = library("pandas")
    frame = pandas.DataFrame({"x": "text", "food": FOOD, "service": SERVICE}, index=list("edcba"))
    for kind in ("float64", "Float64", "object"):
        typed = frame.astype({"service": kind})
        values = MODEL(typed)
        assert type(values) is pandas.DataFrame and list(values.columns) == ["tip"]
        assert list(values.index) == list("edcba")
        assert np.array_equal(values["tip"], EXPECTED, equal_nan=True)
    outcomes = MODEL.evaluate(frame)
    assert list(outcomes.columns) == ["tip", "coverage", "dominant_rule", "clamped"]
    assert outcomes["dominant_rule"].isna().tolist() == [False, True, False, False, True]
    assert outcomes["clamped"].tolist() == [False, False, False, True, False]
    assert np.array_equal(MODEL(frame["service"], frame["food"]), EXPECTED, equal_nan=True)
    assert MODEL(frame.iloc[:0]).shape == (0, 1)
    assert np.array_equal(MODEL(frame.iloc[::-2])["tip"], EXPECTED[::-2], equal_nan=True)
    with pytest.raises(flagred.DataError, match="no column `food`"):
        MODEL(frame[["service"]])
    with pytest.raises(flagred.DataError):
        MODEL(frame.assign(food="much"))


def test_polars():
    polars = library("polars")
    frame = polars.DataFrame({"x": "text", "food": FOOD, "service": SERVICE}, strict=False)
    values = MODEL(frame)
    assert type(values) is polars.DataFrame and values.columns == ["tip"]
    assert values["tip"].is_null().to_list() == [False, True, False, False, True]
    assert np.array_equal(values["tip"].to_numpy(), EXPECTED, equal_nan=True)
    outcomes = MODEL.evaluate(frame)
    assert outcomes.columns == ["tip", "coverage", "dominant_rule", "clamped"]
    assert outcomes["dominant_rule"].to_list() == [2, None, 0, 0, None]
    chunks = polars.concat([frame, frame[:0], frame], rechunk=False)
    assert np.array_equal(MODEL(chunks)["tip"].to_numpy(), np.tile(EXPECTED, 2), equal_nan=True)
    assert np.array_equal(MODEL(frame["service"], frame["food"]), EXPECTED, equal_nan=True)
    with pytest.raises(flagred.DataError, match="collect it first"):
        MODEL(frame.lazy())
    with pytest.raises(flagred.DataError, match="column `food` holds .*, not numbers"):
        MODEL(frame.with_columns(food=polars.lit("much")))
    with pytest.raises(flagred.DataError, match="did you mean `foods`"):
        MODEL(frame.rename({"food": "foods"}))


def test_pyarrow():
    pyarrow = library("pyarrow")
    table = pyarrow.table({"food": FOOD, "service": SERVICE})
    expected = [None if np.isnan(value) else value for value in EXPECTED]
    assert MODEL(table).equals(pyarrow.table({"tip": expected}))
    batch = table.to_batches()[0]
    assert type(MODEL(batch)) is pyarrow.RecordBatch and MODEL(batch)["tip"].to_pylist() == expected
    assert type(MODEL(batch[:0])) is pyarrow.RecordBatch and len(MODEL(batch[:0])) == 0
    assert MODEL(batch[1:3])["tip"].to_pylist() == expected[1:3]
    assert MODEL(table.to_reader(max_chunksize=2))["tip"].to_pylist() == expected
    assert np.array_equal(MODEL(table["service"], table["food"]), EXPECTED, equal_nan=True)
    for kind in ("int8", "uint64", "float16", "float32", "bool", "decimal128(9, 3)", "null"):
        column = pyarrow.nulls(2) if kind == "null" else None
        if column is None:
            arrow = pyarrow.decimal128(9, 3) if kind.startswith("decimal") else getattr(pyarrow, kind + "_" * (kind == "bool"))()
            column = pyarrow.array([1, None], pyarrow.int64()).cast(pyarrow.float32())
            column = column.cast(arrow)
        found = MODEL(pyarrow.table({"service": column, "food": [2.0, 2.0]}))["tip"].to_pylist()
        assert found == [None if kind == "null" else MODEL(1, 2), None]


def test_duckdb():
    duckdb, _ = library("duckdb"), library("pyarrow")
    relation = duckdb.sql("select 9 as food, 8.0 as service union all select null, 3")
    found = MODEL(relation)
    assert type(found) is type(relation)
    assert sorted(found.fetchall(), key=str) == sorted([(MODEL(8, 9),), (None,)], key=str)


def test_our_own_table():
    polars = library("polars")
    table = flagred.loads(GAPS)._table(polars.DataFrame({"heat": [1, 20, 30]}))
    assert list(table) == table.keys() == ["speed", "lamp"] and len(table) == 3
    assert np.isnan(table["speed"][1]) and table["lamp"][1] == 0.25
    with pytest.raises(KeyError):
        table["none"]
    assert polars.DataFrame(table).equals(flagred.loads(GAPS)(polars.DataFrame({"heat": [1, 20, 30]})))
    again = flagred.Model("again").input("speed", range=(0, 9), partition=["a", "b"])
    again.output("out", range=(0, 1), partition=["c", "d"]).rule("IF speed IS a THEN out IS c")
    assert isinstance(again(table), flagred.Table)


def test_a_kept_value_crosses_batches():
    polars = library("polars")
    keeps = flagred.loads(KEEPS)
    part = polars.DataFrame({"heat": [30.0, 22.0]})
    later = polars.concat([part, polars.DataFrame({"heat": [22.0, 10.0]})], rechunk=False)
    found = keeps(later)["speed"].to_list()
    assert found == [keeps(30)] * 3 + [keeps(10)]


NUMBERS = st.one_of(st.none(), st.floats(width=32), st.integers(-20, 20).map(float))


@settings(max_examples=150, deadline=None)
@given(st.lists(st.tuples(NUMBERS, NUMBERS), max_size=40), st.data())
def test_any_frame_keeps_the_order_of_its_rows(rows, data):
    service = [row[0] for row in rows]
    food = [row[1] for row in rows]
    expected = [MODEL(*row) for row in rows]
    name = data.draw(st.sampled_from(["pandas", "polars", "pyarrow"]))
    try:
        module = importlib.import_module(name)
    except ImportError:
        return
    if name == "pandas":
        frame = module.DataFrame({"service": service, "food": food}, dtype=data.draw(st.sampled_from(["float64", "object"])))
        found = MODEL(frame)["tip"].to_numpy()
    elif name == "polars":
        kind = data.draw(st.sampled_from([module.Float64, module.Float32]))
        frame = module.DataFrame({"service": service, "food": food}, schema={"service": kind, "food": kind})
        at = data.draw(st.integers(0, len(rows)))
        found = MODEL(module.concat([frame[:at], frame[at:]], rechunk=False))["tip"].to_numpy()
    else:
        kind = data.draw(st.sampled_from([module.float64(), module.float32()]))
        frame = module.table({"service": module.array(service, kind), "food": module.array(food, kind)})
        found = MODEL(frame)["tip"].to_numpy(zero_copy_only=False)
    assert np.array_equal(np.asarray(found, dtype=float), np.array(expected, dtype=float), equal_nan=True)
