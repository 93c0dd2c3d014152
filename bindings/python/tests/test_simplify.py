"""Simplification of rule sets."""

import numpy as np
import pytest

import flagred

FAN = """\
fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 40], partition: [cool, warm, hot]}
  damp: {range: [0, 9], partition: [dry, wet]}
outputs: {speed: {range: [0, 10], terms: {slow: {singleton: 2}, slower: {singleton: 1}, fast: {singleton: 8}}}}
operators: {and: product, implication: product, aggregation: sum}
rules:
  - IF heat IS cool AND damp IS dry THEN speed IS slow
  - IF heat IS cool AND damp IS wet THEN speed IS slower
  - IF heat IS warm THEN speed IS fast
  - IF heat IS hot THEN speed IS fast
"""


@pytest.fixture
def fan() -> flagred.Model:
    return flagred.loads(FAN)


def test_fewer_rules_give_the_same_outputs(fan):
    before = fan.copy()
    found = flagred.simplify(fan)
    assert fan == before
    assert (found.rules, found.dropped, found.inputs) == ([[1], [2], [3, 4]], [], [])
    heat, damp = np.linspace(0, 40, 50), np.linspace(9, 0, 50)
    assert np.allclose(found.model(heat, damp), fan(heat, damp), atol=1e-11)


def test_a_tolerance_drops_inputs_with_little_effect(fan):
    found = flagred.simplify(fan, tolerance=1)
    assert found.inputs == ["damp"]
    assert len(found.model.rules) == 2
    difference = found.difference
    assert difference is not None and abs(difference.after - difference.before) <= 1
    assert set(difference.inputs) == {"heat", "damp"}


def test_rows_are_added_to_the_points(fan):
    rows = {"heat": [1.0, 2.0], "wetness": [9.0, 8.5]}
    more = flagred.simplify(fan, rows, columns={"damp": "wetness"})
    assert more.points == flagred.simplify(fan).points + 2
    alone = flagred.simplify(fan, rows, columns={"damp": "wetness"}, rows_only=True, tolerance=0.2)
    assert (alone.points, alone.inputs) == (2, ["damp"])


def test_mistakes_are_reported(fan):
    with pytest.raises(flagred.DataError, match="tolerance is -1"):
        flagred.simplify(fan, tolerance=-1)
    with pytest.raises(flagred.DataError, match="there are no rows"):
        flagred.simplify(fan, rows_only=True)
    with pytest.raises(flagred.DataError, match="have no column `damp`"):
        flagred.simplify(fan, {"heat": [1.0]})
    with pytest.raises(flagred.DataError, match="`speed`, which is not an input"):
        flagred.simplify(fan, {"heat": [1.0]}, columns={"speed": "x"})
