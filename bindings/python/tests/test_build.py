"""Rule sets built and edited in Python."""

import json

import pytest

import flagred
from conftest import ROOT


def fan() -> flagred.Model:
    return (
        flagred.Model("fan", "keeps cool", operators={"and": "product"})
        .input("temperature", range=(0, 40), unit="°C", partition={"cold": 10, "hot": 30})
        .input("humidity", range=(0, 100), terms={"dry": {"left_shoulder": (20, 60)}, "wet": {"gaussian": {"mean": 90, "sd": 20}}})
        .output("speed", range=(0, 9), partition=["slow", "fast"], defuzzifier="bisector", when_no_rule_fires={"value": 1})
        .rule("IF temperature IS cold THEN speed IS slow", "IF temperature IS hot OR humidity IS wet THEN speed IS fast")
    )


def test_a_model_built_is_the_model_read():
    model = fan()
    text = """
fuzzy: 1
name: fan
description: keeps cool
inputs:
  temperature: {range: [0, 40], unit: °C, partition: {cold: 10, hot: 30}}
  humidity: {range: [0, 100], terms: {dry: {left_shoulder: [20, 60]}, wet: {gaussian: {mean: 90, sd: 20}}}}
outputs:
  speed: {range: [0, 9], partition: [slow, fast], defuzzifier: bisector, when_no_rule_fires: {value: 1}}
operators: {and: product}
rules:
  - IF temperature IS cold THEN speed IS slow
  - IF temperature IS hot OR humidity IS wet THEN speed IS fast
"""
    assert model == flagred.loads(text) == flagred.loads(model.to_yaml())
    assert model(35, 20) == flagred.loads(text)(35, 20)
    document = model.to_dict()
    assert [one["name"] for one in document["inputs"]] == ["temperature", "humidity"]
    assert document["inputs"][1]["terms"][1] == {"name": "wet", "gaussian": {"mean": 90, "sd": 20}}
    assert flagred.loads(json.dumps(document, sort_keys=True)) == model


def test_every_conformance_model_round_trips():
    files = sorted((ROOT / "tests/conformance").glob("*.yaml"))
    assert len(files) >= 8
    for file in files:
        model = flagred.loads(file.read_text(encoding="utf-8").split("\n---\n")[0])
        assert flagred.loads(model.to_yaml()) == model
        again = model.copy()
        again.description = "for a moment"
        assert again != model
        again.description = model.description
        assert again == model, file.name


def test_edits():
    model = fan()
    rule = model.rules[1]
    rule.weight = 0.5
    assert rule.text.endswith("WITH 0.5") and model.rules[-1].weight == 0.5
    rule.weight = 1
    assert rule.text == fan().rules[1].text and model == fan()
    rule.note, rule.confidence = "by ear", 0.75
    assert (rule.note, rule.confidence, rule.support) == ("by ear", 0.75, None)
    rule.note = rule.confidence = None
    assert model == fan()
    model.rules[0] = "IF temperature IS very cold THEN speed IS slow"
    model.rules.append("IF humidity IS dry THEN speed IS slow")
    model.rules.insert(0, model.rules[2])
    assert [str(rule)[3:14] for rule in model.rules] == ["humidity IS", "temperature", "temperature", "humidity IS"]
    del model.rules[1:3]
    assert len(model.rules) == 2 and model.rules[0].text == model.rules[1].text
    model.inputs["temperature"].range = (0, 50)
    assert model.inputs["temperature"].range == [0, 50] and model.inputs["temperature"].unit == "°C"
    model.inputs["temperature"].terms = {"any": {"rectangle": [0, 50]}}
    assert model.inputs["temperature"].partition is None
    model.outputs["speed"].defuzzifier = "centroid"
    model.operators["and"] = "minimum"
    assert dict(model.operators)["and"] == "minimum"
    model.name = "other"
    assert model.name == "other" and model == flagred.loads(model.to_yaml())
    del model.inputs["temperature"]
    assert list(model.inputs) == ["humidity"]
    model.inputs["load"] = {"range": [0, 1], "partition": ["low", "high"]}
    assert list(model.inputs) == ["humidity", "load"]


@pytest.mark.parametrize(
    ("edit", "code"),
    [
        (lambda m: setattr(m.rules[0], "weight", 3), "weight-outside-range"),
        (lambda m: m.rule("IF temperature IS cld THEN speed IS slow"), "unknown-term"),
        (lambda m: m.rule("IF x"), "rule-syntax"),
        (lambda m: m.inputs.__delitem__("humidity"), "unknown-variable"),
        (lambda m: setattr(m.inputs["humidity"], "range", (1,)), "wrong-type"),
        (lambda m: setattr(m.outputs["speed"], "defuzzifier", "centre"), "unknown-word"),
        (lambda m: m.operators.__setitem__("xor", "minimum"), "unknown-key"),
        (lambda m: m.input("wind", range=(3, 1), partition=["a", "b"]), None),
        (lambda m: m.input("wind", range=(0, float("nan")), partition=["a", "b"]), None),
        (lambda m: m.input("speed", range=(0, 1), partition=["a", "b"]), None),
        (lambda m: m.rules[9], None),
    ],
)
def test_a_wrong_edit_changes_nothing(edit, code):
    model = fan()
    with pytest.raises((flagred.FlagredError, IndexError)) as error:
        edit(model)
    if code:
        assert code in [finding.code for finding in error.value.findings]
    assert model == fan() and model(35, 20) == fan()(35, 20)


def test_rules_in_blocks():
    text = (ROOT / "tests/conformance/blocks.yaml").read_text(encoding="utf-8").split("\n---\n")[0]
    model = flagred.loads(text)
    rules = [rule.text for rule in model.rules]
    model.rules[len(rules) - 1].note = "the last"
    assert model.rules[-1].note == "the last" and [rule.text for rule in model.rules] == rules


def test_an_unfinished_model_reports_its_missing_parts():
    with pytest.raises(flagred.RuleSetError) as error:
        flagred.Model("empty")(1)
    assert [finding.code for finding in error.value.findings] == ["missing-key", "no-rules"]
