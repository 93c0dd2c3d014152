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
    with pytest.raises(flagred.DataError, match="are not a valid snapshot"):
        assert_map(model, path, points=1000)
    assert_map(model, path, points=5)
    monkeypatch.delenv("FLAGRED_UPDATE")
    assert len(path.read_text().splitlines()) == 26
    assert_map(model, path)
    changed = flagred.loads(FAN.replace("IS NOT hot THEN fan IS slow", "IS NOT hot THEN fan IS fast"))
    with pytest.raises(AssertionError, match="`fan` differs at .* of 25 points, most in line .*, at temperature = "):
        assert_map(changed, path)
    # Where no rule fires there is no value, in the snapshot and now.
    assert any(line.endswith(",") for line in path.read_text().splitlines())


def test_an_update_keeps_the_points_of_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "limits.csv"
    path.write_text("site,temperature,fan,humidity,coverage,filled\n'-1,19.999,0,80,1,0\n\nb,30.0,0,8e1,1,0\n")
    with pytest.raises(AssertionError, match="most in line 4, at temperature = 30, humidity = 80"):
        assert_map(flagred.loads(FAN), path)
    monkeypatch.setenv("FLAGRED_UPDATE", "1")
    assert_map(flagred.loads(FAN), path)
    header, *rows = path.read_text().splitlines()
    assert header == "site,temperature,fan,humidity"
    assert [row.split(",")[:2] + row.split(",")[3:] for row in rows] == [["'-1", "19.999", "80"], ["b", "30.0", "8e1"]]
    monkeypatch.delenv("FLAGRED_UPDATE")
    assert_map(flagred.loads(FAN), path)


def test_measured_values_beside_the_snapshot_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "compared.csv"
    path.write_text("temperature,humidity,fan,fan_rules\n5,50,7,\n")
    monkeypatch.setenv("FLAGRED_UPDATE", "1")
    assert_map(flagred.loads(FAN), path, suffix="_rules")
    measured, computed = path.read_text().splitlines()[1].split(",")[2:]
    assert measured == "7" and float(computed) == flagred.loads(FAN)(5, 50)
    monkeypatch.delenv("FLAGRED_UPDATE")
    assert_map(flagred.loads(FAN), path, suffix="_rules")
    with pytest.raises(AssertionError, match="`fan` differs at 1 of 1 points"):
        assert_map(flagred.loads(FAN), path)


def test_a_table_without_the_columns_is_refused(tmp_path: Path) -> None:
    model, path = flagred.loads(FAN), tmp_path / "points.csv"
    for text, message in [
        ("temperature,humidity\n1,2\n", "has no column for an output: fan"),
        ("temperature,fan\n1,2\n", "has no column `humidity`"),
        ("temperature,humidity,fan\n", "has no rows"),
        ("temperature,humidity,fan\n1,2\n", "line 2: 2 cells, but the header has 3"),
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
