"""NumPy arrays: any shape, any strides, any numeric type."""

import os
import pathlib
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from conftest import GAPS, TIP

import flagred

MODEL = flagred.loads(TIP)


def bits(array):
    return np.asarray(array, dtype=np.float64).view(np.uint64)


def one_by_one(model, *arrays):
    arrays = np.broadcast_arrays(*arrays)
    values = [model(*(float(value) for value in row)) for row in zip(*(array.ravel() for array in arrays))]
    return np.array(values, dtype=np.float64).reshape(arrays[0].shape)


ONE_INPUT = """
fuzzy: 1
name: one
inputs: {x: {range: [0, 4], partition: [low, high]}}
outputs: {y: {range: [0, 4], terms: {low: {constant: 1}, high: {constant: 3}}, defuzzifier: weighted_average}}
rules: [IF x IS low THEN y IS low, IF x IS high THEN y IS high]
"""


def test_arrays_that_are_not_aligned_are_copied():
    packed = np.zeros(5, dtype=[("tag", "u1"), ("x", "f8")])
    packed["x"] = [0, 1, 2, 3, 4]
    whole = np.frombuffer(b"\0" + packed["x"].tobytes(), dtype="f8", offset=1)
    assert not whole.flags.aligned and whole.flags.c_contiguous
    model = flagred.loads(ONE_INPUT)
    expected = model(np.arange(5.0))
    assert np.array_equal(model(whole), expected) and np.array_equal(model(packed["x"]), expected)


@pytest.mark.parametrize("threads", [-1, 1.5, "two", 2**70])
def test_threads_are_a_whole_number(threads):
    model = flagred.loads(ONE_INPUT)
    told = "`threads` is .*; it must be a whole number of at least 1"
    for call in (model, model.evaluate):
        with pytest.raises(ValueError, match=told):
            call(np.arange(5.0), threads=threads)
    with pytest.raises(ValueError, match=told):
        model.map(points=3, threads=threads)
    with pytest.raises(ValueError, match=told):
        flagred.tune(model, {"x": [1.0, 2.0], "y": [1.0, 2.0]}, threads=threads)


def test_arrays_have_the_bits_of_single_calls():
    service, food = np.random.default_rng(0).random((2, 5000)) * 14 - 2
    service[::17], food[::23] = np.nan, np.inf
    expected = one_by_one(MODEL, service, food)
    for threads in (None, 1, 2, 5):
        assert np.array_equal(bits(MODEL(service, food, threads=threads)), bits(expected))
    outcomes = MODEL.evaluate(service, food)
    assert np.array_equal(bits(outcomes.value), bits(expected))
    for i in range(0, 5000, 191):
        single = MODEL.evaluate(service[i], food[i])
        rule = None if outcomes.dominant_rule[i] is np.ma.masked else int(outcomes.dominant_rule[i])
        assert (outcomes.coverage[i], rule, bool(outcomes.clamped[i])) == (
            single.coverage,
            single.dominant_rule,
            single.clamped,
        )


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_any_arrays_that_broadcast(data):
    shapes = data.draw(hnp.mutually_broadcastable_shapes(num_shapes=2, max_dims=3, max_side=5))
    kinds = st.sampled_from(["f8", "f4", "f2", "i1", "i4", "i8", "u2", "u8", "?", ">f8", ">i4"])
    arrays = []
    for shape in shapes.input_shapes:
        array = data.draw(hnp.arrays(data.draw(kinds), shape))
        if array.ndim and data.draw(st.booleans()):
            array = array[::-1]
        if array.ndim > 1 and data.draw(st.booleans()):
            array = np.asfortranarray(array)
        if array.ndim and data.draw(st.booleans()):
            array = np.repeat(array, 2, axis=0)[::2]
        arrays.append(array)
    before = [array.copy() for array in arrays]
    found = MODEL(*arrays)
    assert np.shape(found) == shapes.result_shape
    assert np.array_equal(bits(found), bits(one_by_one(MODEL, *arrays)))
    for array, copy in zip(arrays, before):
        assert np.array_equal(array, copy, equal_nan=array.dtype.kind == "f")


def test_representations_of_unknown_values():
    expected = MODEL([8.0, np.nan, 8.0], 9)
    assert np.isnan(expected[1]) and not np.isnan(expected[0])
    masked = np.ma.masked_array([8, 7, 8], mask=[0, 1, 0])
    for given in ([8, None, 8], np.array([8, None, 8], dtype=object), masked):
        assert np.array_equal(MODEL(given, 9), expected, equal_nan=True)


def test_empty_and_scalar_shapes():
    assert MODEL([], []).shape == (0,)
    assert MODEL(np.zeros((0, 3)), 1.0).shape == (0, 3)
    assert type(MODEL(np.float32(8), np.int8(9))) is float
    assert MODEL(np.array(8.0), 9) == MODEL(8, 9)
    assert MODEL(np.zeros((2, 1)), np.zeros(3)).shape == (2, 3)
    read_only = np.array([8.0, 7.0])
    read_only.flags.writeable = False
    assert MODEL(read_only, read_only).shape == (2,)


def test_arrays_without_numbers_are_refused():
    for wrong in (np.array(["a"]), np.array(["2020-01-01"], dtype="M8[D]"), np.array([1j]), [object()]):
        with pytest.raises(flagred.DataError):
            MODEL(wrong, 1.0)


def test_several_outputs_by_name():
    model = flagred.loads(GAPS)
    heat = np.linspace(-5, 45, 2001)
    answers = model(heat)
    assert list(answers) == ["speed", "lamp"]
    for i in range(0, 2001, 101):
        single = model(heat[i])
        assert np.array_equal([answers[name][i] for name in answers], list(single.values()), equal_nan=True)
    assert np.isnan(answers["speed"]).any() and not np.isnan(answers["lamp"]).any()


def test_a_value_that_is_kept_follows_the_order_of_rows(keeps):
    heat = np.concatenate([[22.0], np.full(3000, 30.0), np.full(3000, 22.0), [10.0, 22.0]])
    speed = keeps(heat)
    assert np.isnan(speed[0]) and speed[1] == speed[-3] == keeps(30) and speed[-1] == keeps(10)


def test_numbers_at_odd_addresses_are_read():
    odd = np.zeros(8 * 100 + 1, np.uint8)[1:].view(np.float64)
    odd[:] = np.linspace(0, 10, 100)
    assert not odd.flags.aligned
    assert np.array_equal(MODEL(odd, 5.0), MODEL(odd.copy(), 5.0))
    assert flagred.learn(MODEL, {"service": odd, "food": odd, "tip": odd}).rows == 100


def test_a_matrix_has_a_column_for_each_input(tip):
    X = np.random.default_rng(2).uniform(0, 10, (50, 2))
    expected = tip(X[:, 0], X[:, 1])
    assert np.array_equal(tip(X), expected)
    assert np.array_equal(tip(X.astype(np.float32).astype(float)), tip(*X.astype(np.float32).T))
    assert np.array_equal(tip(X.tolist()), expected)
    assert np.array_equal(tip(np.asfortranarray(X)), expected)
    assert np.array_equal(tip.evaluate(X).coverage, tip.evaluate(X[:, 0], X[:, 1]).coverage)
    assert tip(np.empty((0, 2))).shape == (0,)
    with pytest.raises(flagred.DataError, match="the matrix has 3 columns, but the model has 2 inputs"):
        tip(np.zeros((4, 3)))
    with pytest.raises(flagred.DataError, match="but 1 value was given\n  help: give a value for each input, or a matrix"):
        tip(np.zeros(2))


def test_threads_are_bounded_by_the_cores(tip):
    x = np.linspace(0, 10, 200_000)
    before = threading.active_count()
    expected = tip(x, 9, threads=1)
    tasks = pathlib.Path("/proc/self/task")
    before_tasks = len(list(tasks.iterdir())) if tasks.is_dir() else 0
    assert np.array_equal(tip(x, 9, threads=10**6), expected)
    assert threading.active_count() == before
    if tasks.is_dir():
        assert len(list(tasks.iterdir())) - before_tasks <= (os.cpu_count() or 1)
