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
    assert outcomes["dominant_rule"].to_list() == [3, None, 1, 1, None]
    chunks = polars.concat([frame, frame[:0], frame], rechunk=False)
    assert np.array_equal(MODEL(chunks)["tip"].to_numpy(), np.tile(EXPECTED, 2), equal_nan=True)
    assert np.array_equal(MODEL(frame["service"], frame["food"]), EXPECTED, equal_nan=True)
    with pytest.raises(flagred.DataError, match="collect it first"):
        MODEL(frame.lazy())
    with pytest.raises(flagred.DataError, match="column `food` contains .*, not numbers"):
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
    assert isinstance(again(table), flagred.types.Table)


def test_a_previous_value_is_kept_across_batches():
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


class Capsules:
    """A table that returns its capsules once or repeatedly."""

    def __init__(self, kind, capsules):
        self.kind, self.capsules = kind, capsules

    def __getattr__(self, name):
        if name == f"__arrow_c_{self.kind}__":
            return lambda: self.capsules
        raise AttributeError(name)


def test_a_row_that_is_null_as_a_whole_is_unknown():
    pyarrow = library("pyarrow")
    columns = [pyarrow.array([8.0, 3.0, 4.0]), pyarrow.array([9, 1, 4], pyarrow.int32())]
    mask = pyarrow.array([False, True, False])
    rows = pyarrow.StructArray.from_arrays(columns, ["service", "food"], mask=mask)
    expected = [MODEL(8, 9), None, MODEL(4, 4)]
    by_array = Capsules("array", rows.__arrow_c_array__())
    by_stream = Capsules("stream", pyarrow.chunked_array([rows]).__arrow_c_stream__())
    sliced = Capsules("array", rows[1:].__arrow_c_array__())
    assert pyarrow.table(MODEL(by_array))["tip"].to_pylist() == expected
    assert pyarrow.table(MODEL(by_stream))["tip"].to_pylist() == expected
    assert pyarrow.table(MODEL(sliced))["tip"].to_pylist() == expected[1:]


def test_capsules_that_are_used_up_or_do_not_fit_are_refused(capfd):
    pyarrow = library("pyarrow")
    batch = pyarrow.record_batch({"service": [8.0], "food": [9.0]})
    array, stream = batch.__arrow_c_array__(), pyarrow.table(batch.to_pydict()).__arrow_c_stream__()
    other, numbers = pyarrow.record_batch({"service": [8.0]}).__arrow_c_array__(), pyarrow.array([1.0]).__arrow_c_array__()
    for table in (Capsules("array", array), Capsules("stream", stream)):
        MODEL(table)
        with pytest.raises(flagred.DataError, match="was already consumed"):
            MODEL(table)
    imported = batch.__arrow_c_array__()
    pyarrow.RecordBatch._import_from_c_capsule(*imported)
    fresh = [batch.__arrow_c_array__() for _ in range(4)]
    for kind, capsules, told in [
        ("array", imported, "was already consumed"),
        ("array", (other[0], fresh[0][1]), "does not have the columns of its schema"),
        ("array", (fresh[1][0], numbers[1]), "does not have the columns of its schema"),
        ("array", pyarrow.array([1.0]).__arrow_c_array__(), "is not a table"),
        ("array", fresh[2][::-1], "does not provide a capsule `arrow_schema`"),
        ("array", 7, "does not provide a pair of capsules"),
        ("array", (7, 8), "does not provide a capsule"),
        ("stream", 7, "does not provide a capsule `arrow_array_stream`"),
        ("stream", fresh[3][0], "does not provide a capsule `arrow_array_stream`"),
    ]:
        with pytest.raises(flagred.DataError, match=told):
            MODEL(Capsules(kind, capsules))
    # The panics of the underlying library print nothing.
    assert capfd.readouterr().err == ""


def test_a_column_that_is_there_twice_is_refused():
    pandas, pyarrow = library("pandas"), library("pyarrow")
    twice = pyarrow.Table.from_arrays([pyarrow.array([1.0])] * 3, ["service", "food", "food"])
    frame = pandas.DataFrame([[1.0, 2.0, 3.0]], columns=["service", "food", "food"])
    for table in (twice, frame):
        with pytest.raises(flagred.DataError, match="the column `food` more than once"):
            MODEL(table)
        with pytest.raises(flagred.DataError, match="the column `food` more than once"):
            flagred.learn(MODEL, table, columns={"tip": "service"})
    # A column that no input needs may be duplicated.
    assert MODEL(twice.rename_columns(["service", "x", "x"]).append_column("food", pyarrow.array([1.0]))).num_rows == 1


def test_a_frame_is_explained_rule_by_rule(tip, gaps):
    pandas, polars, pyarrow = (pytest.importorskip(name) for name in ("pandas", "polars", "pyarrow"))
    frame = pandas.DataFrame({"food": [9, 2, np.nan], "service": [8.0, 3.0, 5.0]}, index=["a", "b", "c"])
    found = tip.explain(frame)
    assert list(found.columns) == ["row", "output", "rule", "strength", "share", "dominant_rule"]
    # The last row has an unknown input.
    assert set(found["row"]) == {"a", "b"}
    for row in ("a", "b"):
        why = tip.explain(service=frame.loc[row, "service"], food=frame.loc[row, "food"]).outputs[0]
        rows = found[found["row"] == row]
        expected = [(one.rule, one.strength, one.share) for one in why.rules]
        assert list(rows[["rule", "strength", "share"]].itertuples(index=False, name=None)) == expected
        assert set(rows["output"]) == {"tip"}
        outcome = tip.evaluate(service=frame.loc[row, "service"], food=frame.loc[row, "food"])
        assert set(rows["dominant_rule"]) == {outcome.dominant_rule}
    for again in (tip.explain(polars.from_pandas(frame)), tip.explain(pyarrow.table(frame.reset_index(drop=True)))):
        columns = again.to_dict(as_series=False) if isinstance(again, polars.DataFrame) else again.to_pydict()
        assert columns["row"] == [0 if row == "a" else 1 for row in found["row"]]
        for name in ("output", "rule", "strength", "share", "dominant_rule"):
            assert columns[name] == found[name].tolist()
    several = gaps.explain(pandas.DataFrame({"heat": [5.0, 20.0]}))
    assert several[["row", "output", "rule"]].values.tolist() == [[0, "speed", 1], [0, "lamp", 1]]
    assert len(tip.explain(frame.iloc[:0])) == 0
    with pytest.raises(flagred.DataError, match="no column `food`"):
        tip.explain(frame[["service"]])
