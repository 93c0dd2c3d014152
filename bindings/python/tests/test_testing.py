"""Snapshots of rule sets."""

from __future__ import annotations

from pathlib import Path

import pytest

import flagred
from flagred.testing import assert_map

FAN = """
fuzzy: 1
name: fan
inputs:
  temperature: {range: [0, 40], partition: {cold: 10, mild: 20, hot: 30}}
  humidity: {range: [0, 100], partition: [dry, wet]}
outputs:
  fan: {range: [0, 100], partition: [slow, fast]}
rules:
  - IF temperature IS NOT hot THEN fan IS slow
  - IF temperature IS hot AND humidity IS wet THEN fan IS fast
"""


def test_a_snapshot_is_written_and_compared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model, path = flagred.loads(FAN), tmp_path / "fan.map.csv"
    with pytest.raises(AssertionError, match="FLAGRED_UPDATE=1"):
        assert_map(model, path)
    monkeypatch.setenv("FLAGRED_UPDATE", "1")
    assert_map(model, path, points=5)
    with pytest.raises(flagred.DataError, match="are not a valid snapshot"):
        assert_map(model, path, points=1000)
    monkeypatch.delenv("FLAGRED_UPDATE")
    assert len(path.read_text().splitlines()) == 26
    assert_map(model, path)
    changed = flagred.loads(FAN.replace("IS NOT hot THEN fan IS slow", "IS NOT hot THEN fan IS fast"))
    with pytest.raises(AssertionError, match="`fan` differs at .* of 25 points, most in row .*, at temperature = "):
        assert_map(changed, path)
    # Where no rule fires there is no value, in the snapshot and now.
    assert any(line.endswith(",") for line in path.read_text().splitlines())


def test_a_table_without_the_columns_is_refused(tmp_path: Path) -> None:
    model, path = flagred.loads(FAN), tmp_path / "points.csv"
    for text, message in [
        ("temperature,humidity\n1,2\n", "has no column for an output: fan"),
        ("temperature,fan\n1,2\n", "has no column `humidity`"),
        ("temperature,humidity,fan\n", "has no rows"),
        ("temperature,humidity,fan\n1,2\n", "row 1: 2 cells, but the header has 3"),
    ]:
        path.write_text(text)
        with pytest.raises(flagred.DataError, match=message):
            assert_map(model, path)


def test_steps_are_crisp() -> None:
    model = (
        flagred.Model("credit")
        .input("dti", range=(0, 100), steps={"fine": 36, "stretched": 43, "over": None})
        .output("risk", range=(0, 2), terms={"a": {"constant": 0}, "b": {"constant": 1}, "c": {"constant": 2}}, defuzzifier="weighted_average")
        .rule("IF dti IS fine THEN risk IS a", "IF dti IS stretched THEN risk IS b", "IF dti IS over THEN risk IS c")
    )
    assert [model(x) for x in (35.999, 36, 42.999, 43)] == [0, 1, 1, 2]
    assert "steps: {fine: 36, stretched: 43, over: ~}" in model.to_yaml()
