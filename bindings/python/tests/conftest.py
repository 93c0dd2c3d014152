from pathlib import Path

import pytest

import flagred

ROOT = Path(__file__).resolve().parents[3]

TIP = """\
fuzzy: 1
name: tip
inputs:
  service: {range: [0, 10], partition: [poor, good, excellent]}
  food: {range: [0, 10], partition: [rancid, delicious]}
outputs:
  tip: {range: [0, 30], partition: [low, medium, high]}
rules:
  - IF service IS poor OR food IS rancid THEN tip IS low
  - IF service IS good THEN tip IS medium
  - IF service IS excellent OR food IS delicious THEN tip IS high
"""

# Two outputs and a gap between the rules, in which `lamp` has a default and `speed` has no value.
GAPS = """\
fuzzy: 1
name: gaps
inputs:
  heat: {range: [0, 40], terms: {low: {left_shoulder: [10, 15]}, high: {right_shoulder: [25, 30]}}}
outputs:
  speed: {range: [0, 9], partition: [slow, fast]}
  lamp: {range: [0, 1], partition: ['off', 'on'], when_no_rule_fires: {value: 0.25}}
rules:
  - IF heat IS low THEN speed IS slow AND lamp IS off
  - IF heat IS high THEN speed IS fast AND lamp IS on
"""

KEEPS = """\
fuzzy: 1
name: keeps
inputs: {heat: {range: [0, 40], terms: {low: {left_shoulder: [15, 20]}, high: {right_shoulder: [25, 30]}}}}
outputs: {speed: {range: [0, 9], partition: [slow, fast], when_no_rule_fires: previous}}
rules: [IF heat IS low THEN speed IS slow, IF heat IS high THEN speed IS fast]
"""


@pytest.fixture
def tip() -> flagred.Model:
    return flagred.loads(TIP)


@pytest.fixture
def gaps() -> flagred.Model:
    return flagred.loads(GAPS)


@pytest.fixture
def keeps() -> flagred.Model:
    return flagred.loads(KEEPS)


@pytest.fixture(scope="session")
def steady() -> Path:
    return ROOT / "examples/flights/steady.BIN"
