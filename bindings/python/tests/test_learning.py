"""Rules and numbers from rows."""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import flagred

FAN = """\
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}}
outputs: {speed: {range: [0, 10], terms: {slow: {singleton: 2}, fast: {singleton: 8}}}}
rules: [IF heat IS cool THEN speed IS slow, IF heat IS hot THEN speed IS fast]
"""

HEAT = np.arange(41.0)
SPEED = 2 + 6 * np.clip((HEAT - 20) / 10, 0, 1)


@pytest.fixture
def fan() -> flagred.Model:
    return flagred.loads(FAN)


def frames(columns: dict) -> list:
    """The columns in each installed library."""
    made = [columns]
    for name, make in [
        ("pandas", lambda module: module.DataFrame(columns)),
        ("polars", lambda module: module.DataFrame(columns)),
        ("pyarrow", lambda module: module.table(columns)),
        ("pyarrow", lambda module: module.RecordBatch.from_pydict(columns)),
        ("duckdb", lambda module: module.from_arrow(pytest.importorskip("pyarrow").table(columns))),
    ]:
        try:
            made.append(make(__import__(name)))
        except ImportError:
            continue
    return made


def test_tuning_finds_the_numbers_and_leaves_the_model(fan):
    before = fan.copy()
    tuned = flagred.tune(fan, {"heat": HEAT, "speed": SPEED})
    assert fan == before
    assert tuned.before > 1 and tuned.after < 0.01
    assert (tuned.rows, tuned.refused, tuned.without_value, tuned.validation) == (41, [], 0, None)
    assert {(one.of, one.name) for one in tuned.moved} >= {("heat.cool", "peak"), ("heat.hot", "peak")}
    assert np.allclose(tuned.model(HEAT), SPEED, atol=0.1)


def test_all_frames_give_the_same_bits(fan):
    columns = {"heat": HEAT, "speed": SPEED, "vehicle": np.where(HEAT < 20, "a", "b"), "count": 1 + HEAT % 3}
    texts = set()
    for data in frames(columns):
        tuned = flagred.tune(fan, data, weight="count", group_by="vehicle", folds=2, iterations=5)
        texts.add(tuned.model.to_yaml())
        assert tuned.validation is not None and tuned.validation.folds == 2
        worth = tuned.validation.after
        assert worth.low <= worth.value <= worth.high
    assert len(texts) == 1


def test_settings_of_tuning_are_used(fan):
    data = {"heat": HEAT, "flow": SPEED}
    tuned = flagred.tune(fan, data, only=["speed"], columns={"speed": "flow"}, digits=2)
    assert tuned.model.inputs["heat"].terms == fan.inputs["heat"].terms
    assert {one.of for one in tuned.moved} <= {"speed.slow", "speed.fast"} and tuned.moved
    assert all(float(f"{one.after:.2g}") == one.after for one in tuned.moved)
    first, second = (flagred.tune(fan, data, columns={"speed": "flow"}, starts=2, seed=4, threads=n) for n in (1, 2))
    assert first == second
    rising = flagred.tune(fan, data, columns={"speed": "flow"}, rising=["heat"]).model
    assert np.all(np.diff(rising(np.linspace(0, 40, 500))) >= 0)
    with pytest.raises(flagred.DataError, match="not decreasing in `heat`"):
        flagred.tune(fan, data, columns={"speed": "flow"}, falling=["heat"])
    with pytest.raises(flagred.DataError, match="nothing can be tuned: every number is fixed"):
        flagred.tune(fan, data, columns={"speed": "flow"}, fix=["heat", "speed"])
    with pytest.raises(flagred.DataError, match="no variable and no term `heet`"):
        flagred.tune(fan, data, columns={"speed": "flow"}, only=["heet"])


def test_rules_are_learned(fan):
    learned = flagred.learn(fan, {"heat": [1, 9, 39, 38, 37], "speed": [2, 2, 8, 8, 2]}, resolve="mean")
    assert [rule.text for rule in learned.model.rules] == [
        "IF heat IS cool THEN speed IS slow",
        "IF heat IS hot THEN speed IS fast",
    ]
    assert (learned.rows, learned.rules, learned.conflicts, learned.missing) == (5, 2, 1, 0)
    assert learned.validation is not None and learned.validation.rows + learned.validation.without_prediction == 5
    kept = flagred.learn(fan, {"heat": [1], "speed": [2]}, resolve="mean", keep_rules=True, validation=False)
    assert len(kept.model.rules) == 3 and kept.validation is None


def test_learned_rules_that_do_not_rise_are_reported(fan):
    data = {"heat": [1, 2, 38, 39], "speed": [8, 8, 2, 2]}
    learned = flagred.learn(fan, data, resolve="mean", rising=["heat"], validation=False)
    assert learned.counterexamples == [] and learned.moved > 0
    fan.rules[0].weight = fan.rules[1].weight = 0.9
    data = {"heat": [1, 2], "speed": [2, 2]}
    kept = flagred.learn(fan, data, resolve="mean", falling=["heat"], keep_rules=True, validation=False)
    assert len(kept.counterexamples) == 1 and "`speed` rises from" in kept.counterexamples[0]


def test_bad_rows_are_refused_or_left_out(fan):
    data = {"heat": [1, None, 50, 39], "speed": [2, 2, 8, 8]}
    with pytest.raises(flagred.DataError, match="2 rows cannot be used\n  row 1: `heat` is not a finite number\n  row 2"):
        flagred.learn(fan, data, resolve="mean")
    learned = flagred.learn(fan, data, resolve="mean", skip_bad_rows=True)
    assert learned.rows == 2 and len(learned.refused) == 2
    assert flagred.tune(fan, data, skip_bad_rows=True, iterations=1).rows == 3
    with pytest.raises(flagred.DataError, match="must be 0 or 1"):
        flagred.tune(fan, {"heat": [1], "speed": [2]}, loss="log")


@pytest.mark.parametrize(
    ("data", "options", "message"),
    [
        ({"heat": [1]}, {}, "no column `speed`\n  help: the columns are `heat`"),
        ({"heat": [1, 2], "speed": [1]}, {}, "different lengths: 1, 2"),
        ({"heat": ["a"], "speed": [1]}, {}, "text is not a number"),
        (7, {}, "`int` is not a table"),
        ({"heat": [1], "speed": [1]}, {"columns": {"spede": "x"}}, "not a variable of the rule set"),
        ({"heat": [1], "speed": [1]}, {"weight": "w"}, "no column `w`"),
        ({"heat": [], "speed": []}, {}, "no rows"),
    ],
)
def test_data_that_cannot_be_used(fan, data, options, message):
    with pytest.raises(flagred.DataError, match=message):
        flagred.learn(fan, data, **options)
    with pytest.raises(flagred.DataError, match=message):
        flagred.tune(fan, data, **options)


@pytest.mark.parametrize("call", [flagred.learn, flagred.tune])
def test_unknown_words(fan, call):
    word = {flagred.learn: "resolve", flagred.tune: "loss"}[call]
    with pytest.raises(flagred.DataError, match=f"`{word}` is `best`\n  help: write"):
        call(fan, {"heat": [1], "speed": [1]}, **{word: "best"})


def test_a_rule_set_without_rules_cannot_be_tuned():
    model = flagred.Model("fan").input("heat", range=(0, 1), partition=["a", "b"])
    with pytest.raises(flagred.RuleSetError):
        flagred.tune(model, {"heat": [1]})


def search_without_end(tip: flagred.Model, **options: int) -> None:
    random = np.random.default_rng(0)
    rows = 20_000
    data = {"service": random.uniform(0, 10, rows), "food": random.uniform(0, 10, rows), "tip": random.uniform(5, 25, rows)}
    flagred.tune(tip, data, starts=100_000, iterations=10_000, **options)


def interrupt_after(seconds: float) -> None:
    threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as POSIX does")
@pytest.mark.parametrize("folds", [None, 3])
def test_an_interrupt_ends_a_search_and_keeps_the_best(tip, folds):
    interrupt_after(1.0)
    begun = time.monotonic()
    with pytest.raises(flagred.TuneInterrupted, match="`best` of this exception") as stop:
        search_without_end(tip, folds=folds)
    assert time.monotonic() - begun < 30
    best = stop.value.best
    assert best.after < best.before and best.moved and best.validation is None
    assert best.model != tip and 0 <= best.model(8, 9) <= 30
    assert pickle.loads(pickle.dumps(stop.value)).best == best


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as POSIX does")
def test_an_interrupt_that_is_not_caught_ends_a_program():
    program = "import test_learning, conftest, flagred; tip = flagred.loads(conftest.TIP); print(flush=True)\n"
    program += "test_learning.search_without_end(tip)"
    search = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=Path(__file__).parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert search.stdout is not None and search.stdout.readline()
    time.sleep(1)
    search.send_signal(signal.SIGINT)
    _, told = search.communicate(timeout=60)
    assert search.returncode != 0 and "TuneInterrupted: tuning was interrupted" in told, told


def cars(count: int = 300) -> dict:
    random = np.random.default_rng(3)
    weight, year = random.uniform(1500, 5000, count), random.integers(70, 83, count)
    mpg = 60 - 0.012 * weight + 0.4 * (year - 70) + 3 * np.sin(weight / 500)
    return {"weight": weight, "year": year, "name": np.array([f"car {i}" for i in range(count)]), "mpg": mpg}


def test_identifying_finds_the_relevant_inputs_in_any_frame():
    found = [flagred.identify(frame, "mpg", validation=False) for frame in frames(cars())]
    assert all(one.model == found[0].model for one in found)
    assert set(found[0].model.inputs) == {"weight", "year"}
    assert found[0].validation is None and found[0].steps[0].input == "weight"


@pytest.mark.parametrize("antecedents", ["partitions", "clusters"])
@pytest.mark.parametrize("consequents", ["constants", "lines"])
def test_identifying_is_compared_with_a_line(antecedents, consequents):
    found = flagred.identify(cars(), "mpg", antecedents=antecedents, consequents=consequents)
    worth = found.validation
    assert worth.ratio.value == pytest.approx(worth.identified.value / worth.linear.value)
    assert worth.linear.value < worth.mean.value and worth.folds == 5
    assert found.model(*(cars()[name] for name in found.model.inputs)).shape == (300,)


def test_identifying_refuses_unusable_data():
    rows = cars()
    rows["weight"] = rows["weight"].copy()
    rows["weight"][7] = np.nan
    with pytest.raises(flagred.DataError, match="column `weight`, row 7"):
        flagred.identify(rows, "mpg")
    assert len(flagred.identify(rows, "mpg", skip_bad_rows=True, validation=False).steps) > 0
    with pytest.raises(flagred.DataError, match="no column `colour`"):
        flagred.identify(rows, "mpg", inputs=["colour"])
    with pytest.raises(flagred.DataError, match="`antecedents` is `grid`"):
        flagred.identify(cars(), "mpg", antecedents="grid")
    with pytest.raises(flagred.DataError, match="no input predicts the output better"):
        flagred.identify({"a": np.arange(50.0) % 2, "b": np.zeros(50)}, "b")


@pytest.mark.parametrize("resolve", ["strongest", "heaviest", "mean"])
@pytest.mark.parametrize(
    "terms",
    [
        "{slow: {constant: 0}, medium: {constant: 50}, fast: {constant: 100}}, defuzzifier: weighted_average",
        "{slow: {singleton: 0}, medium: {singleton: 50}, fast: {singleton: 100}}",
    ],
)
def test_learning_for_numbers(resolve, terms):
    variables = flagred.loads(
        "{fuzzy: 1, name: fan, inputs: {heat: {range: [0, 40], partition: {cold: 10, mild: 20, hot: 30}}}, "
        f"outputs: {{speed: {{range: [0, 100], terms: {terms}}}}}, rules: []}}"
    )
    rows = {"heat": HEAT, "speed": np.clip(5 * (HEAT - 10), 0, 100)}
    learned = flagred.learn(variables, rows, resolve=resolve)
    assert [rule.text for rule in learned.model.rules] == [
        "IF heat IS cold THEN speed IS slow",
        "IF heat IS mild THEN speed IS medium",
        "IF heat IS hot THEN speed IS fast",
    ]


def test_tuned_numbers_are_short_and_rows_must_count():
    heat = np.linspace(0, 40, 81)
    rows = {"heat": heat, "speed": 3.123456 + 0.123456 * heat, "none": np.zeros(81)}
    text = "fuzzy: 1\nname: fan\ninputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}}\noutputs:\n  speed: {range: [0, 7], "
    text += "terms: {slow: {constant: 2}, fast: {constant: 6}}, defuzzifier: weighted_average}\nrules:\n"
    text += "  - IF heat IS cool THEN speed IS slow\n  - IF heat IS hot THEN speed IS fast\n"
    fan = flagred.loads(text)
    short = flagred.tune(fan, rows)
    assert all(len(f"{one.after:g}".replace(".", "").lstrip("0")) <= 3 and one.after <= 40 for one in short.moved)
    exact = flagred.tune(fan, rows, digits=None)
    assert any(len(repr(one.after)) > 6 for one in exact.moved)
    fast = [one.after for one in exact.moved if one.of == "speed.fast"]
    assert all(value <= 7 for value in fast)
    beyond = flagred.tune(fan, rows, only=["speed"], beyond_range=True)
    assert max(one.after for one in beyond.moved) > 7
    far = flagred.tune(fan, {**rows, "speed": 1000 + heat}, only=["speed"])
    assert [one.after for one in far.moved] == [7, 7] and far.at_bounds == ["speed.slow", "speed.fast"]
    for weight, told in [("none", "the weights of all rows are 0"), ("heat", None)]:
        if told is None:
            flagred.tune(fan, rows, weight=weight, folds=10)
        else:
            with pytest.raises(flagred.DataError, match=told):
                flagred.tune(fan, rows, weight=weight)
    with pytest.raises(flagred.DataError, match="row 80: the value 1e308 is outside the range"):
        flagred.tune(fan, rows | {"speed": np.append(rows["speed"][:-1], 1e308)})


def test_the_provenance_is_written_into_the_rule_set():
    text = """# The fan.
fuzzy: 1
name: fan
inputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}} # sensor 1
outputs: {speed: {range: [0, 10], terms: {slow: {singleton: 2}, fast: {singleton: 8}}}}
rules:
  - IF heat IS cool THEN speed IS slow # quiet
  - IF heat IS hot THEN speed IS fast
"""
    rows = {"heat": HEAT, "speed": SPEED}
    tuned = flagred.tune(flagred.loads(text), rows, folds=3)
    step = tuned.model.to_dict()["provenance"][-1]
    assert (step["command"], step["rows"], step["seed"]) == ("flagred.tune", len(HEAT), 0)
    assert step["loss"]["after"] == pytest.approx(tuned.after, rel=1e-5, abs=1e-12)
    assert len(step["moved"]) == len(tuned.moved) > 0 and "in 3 folds" in step["note"]
    # Only numbers changed, so comments stay.
    assert "# sensor 1" in tuned.model.text and "# quiet" in tuned.model.text
    assert not [finding for finding in tuned.model.check() if finding.code == "edited-since"]
    learned = flagred.learn(flagred.loads(text), rows)
    step = learned.model.to_dict()["provenance"][-1]
    assert (step["command"], step["rows"]) == ("flagred.learn", learned.rows)
    assert f"{learned.rules} rules learned" in step["note"]
    assert learned.model.text.startswith("# The fan.")


def test_terms_from_data_by_c_means():
    found = flagred.c_means([-1, 0, 1], 2)
    # By symmetry the centers are -c and c, with c = s / ((1 + s^2) / 2 + 1/4) and s = 2 c / (1 + c^2).
    c = found.centers[1]
    s = 2 * c / (1 + c * c)
    assert found.centers[0] == pytest.approx(-c) and c == pytest.approx(s / ((1 + s * s) / 2 + 0.25), abs=1e-6)
    assert found.degrees[1] == pytest.approx([0.5, 0.5]) and found.degrees.sum(axis=1) == pytest.approx(1)
    heaps = np.random.default_rng(0).normal([[8, 0], [20, 5], [35, 9]], 0.5, (40, 3, 2)).reshape(-1, 2)
    found = flagred.c_means(heaps, 3, seed=3)
    assert found.centers.round(0).tolist() == [[8, 0], [20, 5], [35, 9]]
    assert np.array_equal(found.degrees, flagred.c_means(heaps, 3, seed=3).degrees)
    partition = flagred.c_means(heaps[:, 0], 3).partition(["cool", "warm", "hot"])
    fan = flagred.Model("fan").input("heat", range=(0, 40), partition=partition)
    assert list(fan.inputs["heat"]) == ["cool", "warm", "hot"] and fan.inputs["heat"]["warm"](partition["warm"]) == 1
    for call, message in (
        (lambda: flagred.c_means([1, 2], 1), "`clusters` is 1; it must be at least 2"),
        (lambda: flagred.c_means([1, np.nan], 2), "row 1 has an unknown value"),
        (lambda: flagred.c_means([1, 1], 2), "there are 1"),
        (lambda: flagred.c_means([1, 2], 2, fuzzifier=1), "`fuzzifier` is 1"),
        (lambda: found.partition(["a", "b", "c"]), "several columns"),
        (lambda: flagred.c_means([1, 2, 3], 2).partition(["a"]), "2 clusters but 1 name"),
    ):
        with pytest.raises(flagred.DataError, match=message):
            call()


def test_options_of_another_type_are_reported_in_plain_words():
    fan = flagred.load("flagred-paper")
    rows = {"margin": [0.1, 0.5], "spread": [0.1, 0.2], "risk": [50, 10]}
    for call, message in (
        (lambda: flagred.tune(fan, rows, seed=-1), "`seed` is -1; it must be a whole number of at least 0"),
        (lambda: flagred.tune(fan, rows, folds="a"), "`folds` is 'a'"),
        (lambda: flagred.learn(fan, rows, min_support=1.5), "`min_support` is 1.5"),
        (lambda: flagred.simplify(fan, seed="x"), "`seed` is 'x'"),
        (lambda: flagred.c_means([1, 2, 3], "a"), "`clusters` is 'a'"),
        (lambda: flagred.learn(fan, {}), "no column `margin`\n  help: they have no columns"),
    ):
        with pytest.raises(flagred.DataError, match=message):
            call()
    one, several = (flagred.learn(fan, rows, rising=names, validation=False) for names in ("spread", ["spread"]))
    assert one.model == several.model
