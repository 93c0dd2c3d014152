"""Every way of evaluation gives the outcomes of the corpus, which all languages share, bit for bit."""

import math
import re
import struct

import numpy as np
import pytest

import flagred
from conftest import ROOT

OPERATORS = ("and", "or", "implication", "aggregation")


def bits(value):
    return "none" if math.isnan(value) else f"{struct.unpack('>Q', struct.pack('>d', value))[0]:x}"


def said(outcome):
    value = math.nan if outcome.value is None else outcome.value
    rule = "none" if outcome.dominant_rule is None else outcome.dominant_rule - 1
    return f"{bits(value)},{bits(outcome.coverage)},{rule},{int(outcome.clamped)}"


def corpus():
    """The cases: the position of each, its model, its point, and the bits of its outcomes."""
    on_file = {}
    for line in (ROOT / "tests/conformance.bits").read_text().splitlines():
        file, number, *outcomes = line.split(" ")
        on_file[file, int(number)] = outcomes
    for file in sorted((ROOT / "tests/conformance").glob("*.yaml")):
        text, cases = file.read_text(encoding="utf-8").split("\n---\n")
        models = {}
        for number, line in enumerate(cases.splitlines()):
            settings = dict(re.findall(r"(\w+): ([a-z_]+)\b", line.split("at: ")[0]))
            key = tuple(sorted(settings.items()))
            if key not in models:
                models[key] = flagred.loads(text)
                for name, word in key:
                    if name in OPERATORS:
                        models[key].operators[name] = word
                    else:
                        assert name == "defuzzifier"
                        for output in models[key].outputs.values():
                            output.defuzzifier = word
            point = [float(x) for x in re.search(r"at: \[(.*?)\]", line)[1].split(", ")]
            yield f"{file.name} {number}", models[key], point, on_file.pop((file.name, number))
    assert not on_file


CORPUS = list(corpus())


def test_the_corpus_is_as_large_as_it_should_be():
    assert len(CORPUS) >= 400


def test_single_calls():
    for place, model, point, expected in CORPUS:
        outcomes = model.evaluate(*point)
        outcomes = [outcomes] if len(expected) == 1 else list(outcomes.values())
        assert [said(outcome) for outcome in outcomes] == expected, place
        values = model(*point)
        values = [values] if len(expected) == 1 else list(values.values())
        assert [bits(value) for value in values] == [outcome.split(",")[0] for outcome in expected], place


@pytest.mark.parametrize("threads", [1, 3])
def test_arrays(threads):
    for place, model, point, expected in CORPUS:
        if any(output.when_no_rule_fires == "previous" for output in model.outputs.values()):
            continue
        columns = [np.full(2500 if place.endswith(" 0") else 3, x) for x in point]
        found = model.evaluate(*columns, threads=threads)
        found = [found] if len(expected) == 1 else list(found.values())
        for outcomes, line in zip(found, expected):
            value, coverage, rule, clamped = line.split(",")
            assert {bits(x) for x in outcomes.value} == {value}, place
            assert {bits(x) for x in outcomes.coverage} == {coverage}, place
            assert set(outcomes.dominant_rule.tolist()) == {None if rule == "none" else int(rule) + 1}, place
            assert set(outcomes.clamped.tolist()) == {clamped == "1"}, place


def test_frames():
    polars = pytest.importorskip("polars")
    for place, model, point, expected in CORPUS:
        frame = polars.DataFrame({name: [x] for name, x in zip(model.inputs, point)}, schema_overrides=None)
        found = model(frame).row(0)
        values = [math.nan if value is None else value for value in found]
        assert [bits(value) for value in values] == [outcome.split(",")[0] for outcome in expected], place


def test_maps_and_explanations():
    for place, model, point, expected in CORPUS:
        first, *others = model.inputs
        for output, line in zip(model.outputs, expected):
            cut = model.map(points=3, output=output, **dict(zip(others, point[1:])))
            at = cut.axes[first]
            for i in range(3):
                outcome = model.evaluate(at[i], *point[1:])
                outcome = outcome if len(expected) == 1 else outcome[output]
                assert bits(cut.values[i]) == said(outcome).split(",")[0], place
        values = model.explain(*point).values.values()
        values = [math.nan if value is None else value for value in values]
        assert [bits(value) for value in values] == [line.split(",")[0] for line in expected], place
