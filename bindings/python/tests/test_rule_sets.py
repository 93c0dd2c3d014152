"""Rule sets: reading, evaluation, explanations, maps, copies."""

import copy
import math
import os
import pickle
import pydoc
import shutil
import subprocess
import sys
import threading

import numpy as np
import pytest
from conftest import ROOT, TIP
from hypothesis import given, settings
from hypothesis import strategies as st

import flagred
import flagred.learning


def test_built_in_rule_sets_are_loaded_by_their_names():
    for name in ("flagred", "flagred-battery", "flagred-paper"):
        assert flagred.load(name).text == (ROOT / "rules" / f"{name}.yaml").read_text(encoding="utf-8")
    with pytest.raises(OSError):
        flagred.load("./flagred")


def test_numbers_by_position_and_by_name(tip):
    value = tip(8, 9)
    assert type(value) is float
    assert value == tip(service=8, food=9) == tip({"food": 9, "service": 8}) == tip(8.0, np.float64(9))
    outcome = tip.evaluate(food=9, service=8)
    assert (outcome.value, float(outcome), outcome.dominant_rule, outcome.clamped) == (value, value, 3, False)
    assert outcome.state == "defined"
    assert outcome.coverage == 0.9
    assert outcome == tip.evaluate(8, 9) != tip.evaluate(8, 8)
    assert tip.evaluate(11, 9).clamped
    assert repr(outcome).startswith("Outcome(value=18.39")


def test_unknown_is_not_a_number(tip, gaps):
    for unknown in (None, math.nan, math.inf):
        assert math.isnan(tip(8, unknown))
        assert tip.evaluate(8, unknown).value is None
        assert tip.evaluate(8, unknown).state == "input_not_finite"
    answers = gaps.evaluate(20)
    assert answers["speed"].value is None and answers["speed"].dominant_rule is None
    assert answers["speed"].state == "no_rule_fired"
    assert (answers["lamp"].value, answers["lamp"].state) == (0.25, "default")
    assert math.isnan(gaps(20)["speed"]) and gaps(20)["lamp"] == 0.25


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda tip: tip(1), "the model has 2 inputs, but 1 value was given"),
        (lambda tip: tip(servce=1, food=2), "there is no input `servce`\n  help: did you mean `service`?"),
        (lambda tip: tip(service=1), "input `food` has no value"),
        (lambda tip: tip(1, food=2), "values are given both by position and by name"),
        (lambda tip: tip("a", "b"), "text is not a number"),
        (lambda tip: tip([1, 2], [1, 2, 3]), "cannot be broadcast together"),
        (lambda tip: tip([1], [2], threads=0), "at least 1"),
        (lambda tip: tip.map(bill=3), "there is no input `bill`"),
        (lambda tip: tip.map(points=1), "at least 2 points"),
        (lambda tip: tip.map(output="top"), "did you mean `tip`?"),
        (lambda tip: tip.explain([1, 2], [3, 4]), "arrays cannot be explained"),
        (lambda tip: tip.explain(1, math.nan), "not a finite number"),
        (lambda tip: tip.check(rising=["servce"]), "did you mean `service`?"),
        (lambda tip: tip.check(rising=3), "3 is not a list of inputs"),
    ],
)
def test_mistakes_are_reported(tip, ask, message):
    with pytest.raises(flagred.DataError) as error:
        ask(tip)
    assert message in str(error.value)


def test_a_model_that_must_fire_reports_where_it_does_not():
    model = flagred.loads(TIP.replace("high]}\nrules", "high], when_no_rule_fires: error}\nrules"))
    model.rules[1] = "IF service IS good AND food IS delicious THEN tip IS medium"
    del model.rules[2]
    del model.rules[0]
    with pytest.raises(flagred.DataError, match="no rule fired for output `tip`"):
        model(0, 0)
    assert math.isnan(model([0.0], [0.0])[0])


def test_errors_are_drawn_and_listed():
    with pytest.raises(flagred.RuleSetError) as error:
        flagred.loads(TIP.replace("IS good", "IS god").replace("range: [0, 30]", "range: [30, 0]"))
    first, second = error.value.findings
    assert (second.code, second.line, second.column, second.severity) == ("unknown-term", 10, 19, "error")
    assert (second.message, second.help) == ("input `service` has no term `god`", "did you mean `good`?")
    assert first.line == 7 and first.file == "<text>"
    assert "--> <text>:10:19" in str(error.value) and str(error.value).count("^") >= 2
    assert str(second) in str(error.value)
    again = pickle.loads(pickle.dumps(error.value))
    assert again.findings == error.value.findings and str(again) == str(error.value)
    assert isinstance(error.value, flagred.FlagredError) and isinstance(error.value, ValueError)


def test_files(tmp_path, tip):
    tip.save(tmp_path / "tip.yaml")
    assert flagred.load(tmp_path / "tip.yaml") == tip
    (tmp_path / "wide.yaml").write_bytes(TIP.encode("utf-16"))
    assert flagred.load(str(tmp_path / "wide.yaml")) == tip
    (tmp_path / "latin.yaml").write_bytes(b"fuzzy: 1 # \xe9")
    with pytest.raises(flagred.RuleSetError, match="not UTF-8: byte 11 is E9"):
        flagred.load(tmp_path / "latin.yaml")
    with pytest.raises(FileNotFoundError):
        flagred.load(tmp_path / "none.yaml")
    (tmp_path / "bad.yaml").write_text("fuzzy: 1\n")
    with pytest.raises(flagred.RuleSetError) as error:
        flagred.load(tmp_path / "bad.yaml")
    assert error.value.findings[0].file == str(tmp_path / "bad.yaml")


FIS = """
[System]
Name='fan'
Type='sugeno'
[Input1]
Name='heat'
Range=[0 40]
MF1='high':'trimf',[10 30 50]
[Output1]
Name='speed'
Range=[0 9]
MF1='fast':'linear',[0.2 1]
[Rules]
1, 1 (1) : 1
"""

FLL = """
Engine: fan
InputVariable: heat
  range: 0 40
  term: high Ramp 20 30
OutputVariable: speed
  range: 0 9
  aggregation: Maximum
  defuzzifier: Centroid 100
  term: fast Triangle 5 7 9
RuleBlock:
  implication: Minimum
  rule: if heat is high then speed is fast
"""

FCL = """
FUNCTION_BLOCK fan
VAR_INPUT heat : REAL; END_VAR
VAR_OUTPUT speed : REAL; END_VAR
FUZZIFY heat
  RANGE := (0 .. 40);
  TERM high := (20, 0) (30, 1);
END_FUZZIFY
DEFUZZIFY speed
  RANGE := (0 .. 9);
  TERM fast := (5, 0) (7, 1) (9, 0);
  METHOD : COG;
END_DEFUZZIFY
RULEBLOCK only
  AND : MIN;
  ACT : MIN;
  ACCU : MAX;
  RULE 1 : IF heat IS high THEN speed IS fast;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(("text", "value"), [(FIS, 7.0), (FLL, 7.0), (FCL, 7.0)])
def test_formats_of_other_programs(text, value):
    model = flagred.loads(text)
    assert model(30) == pytest.approx(value, abs=1e-3)
    assert flagred.loads(model.to_yaml()) == model
    with pytest.raises(flagred.RuleSetError) as error:
        flagred.loads(text.replace("high", "hot", 1).replace("1, 1 (1)", "2, 1 (1)"))
    assert error.value.findings[0].line > 1


def test_explanations(tip):
    explanation = tip.explain(service=8, food=9)
    assert explanation.values == {"tip": tip(8, 9)}
    assert explanation.inputs[0].terms == pytest.approx({"poor": 0, "good": 0.4, "excellent": 0.6})
    assert [rule.rule for rule in explanation.rules] == [3, 2, 1]
    assert explanation.rules[0].text == tip.rules[2].text
    (output,) = explanation.outputs
    assert sum(share.share for share in output.rules) == pytest.approx(1)
    assert output.set_at.shape == output.set_degree.shape and output.set_degree.max() == pytest.approx(0.9, abs=0.01)
    assert explanation._repr_svg_().startswith("<svg ") and "degree of 8" in str(explanation)


def test_maps(tip, gaps):
    whole = tip.map(points=11)
    assert whole.values.shape == whole.coverage.shape == whole.dominant_rule.shape == (11, 11)
    assert list(whole.axes) == ["service", "food"] and whole.fixed == {}
    service, food = np.meshgrid(*whole.axes.values(), indexing="ij")
    assert np.array_equal(whole.values, tip(service, food))
    assert np.array_equal(whole.coverage, tip.evaluate(service, food).coverage)
    cut = tip.map(points=5, food=9)
    assert cut.fixed == {"food": 9} and np.array_equal(cut.values, tip(cut.axes["service"], 9))
    for kind in ("map", "rules", "surface"):
        assert whole.svg(kind).startswith("<svg ")
    assert cut._repr_svg_().startswith("<svg ")
    with pytest.raises(flagred.DataError, match="two axes"):
        cut.svg("surface")
    speed = gaps.map(output="speed", points=41)
    assert np.isnan(speed.values[20]) and speed.dominant_rule[20] is np.ma.masked


def test_findings_of_a_check(tip):
    codes = [finding.code for finding in tip.check()]
    assert "narrow-reach" in codes
    assert "not-monotone" not in codes
    assert "not-monotone" in [finding.code for finding in tip.check(falling="service")]


def test_copies_are_independent(tip):
    for other in (copy.copy(tip), copy.deepcopy(tip), tip.copy(), pickle.loads(pickle.dumps(tip))):
        assert other == tip and type(other) is flagred.Model
        other.rules[0].weight = 0.5
        assert other != tip and tip.rules[0].weight == 1
    unfinished = flagred.Model("empty")
    assert pickle.loads(pickle.dumps(unfinished)) == unfinished
    outcome = tip.evaluate(8, 9)
    assert pickle.loads(pickle.dumps(outcome)) == outcome


def test_pictures(tip, tmp_path):
    picture = tip.plot()
    assert str(picture).startswith("<svg ") and "excellent" in str(picture)
    picture.save(tmp_path / "tip.svg")
    assert (tmp_path / "tip.svg").read_text(encoding="utf-8") == picture._repr_svg_()


def test_maps_on_axes_of_matplotlib(tip):
    assert str(tip.map(points=11).plot()).startswith("<svg ")
    figure = pytest.importorskip("matplotlib.figure").Figure()
    ax, other, third = figure.subplots(1, 3)
    assert tip.map(points=11).plot(ax) is ax
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("service", "food") and len(figure.axes) == 4
    assert tip.map(points=5, food=9).plot(other) is other and other.get_ylabel() == "tip"
    assert np.array_equal(other.lines[0].get_ydata(), tip.map(points=5, food=9).values)
    three = flagred.Model("three").output("out", range=(0, 1), partition=["c", "d"])
    for name in "xyz":
        three.input(name, range=(0, 1), partition=["a", "b"])
    three.rule("IF x IS a AND y IS a AND z IS a THEN out IS c")
    with pytest.raises(flagred.DataError, match="one or two axes"):
        three.map(points=3).plot(third)


def test_many_threads_at_once(tip):
    service, food = np.random.default_rng(1).random((2, 20_000)) * 10
    expected = tip(service, food)
    wrong = []

    def ask(i):
        part = slice(i * 1000, None)
        if not np.array_equal(tip(service[part], food[part]), expected[part]) or tip(8, 9) != tip(8, 9):
            wrong.append(i)
        if i == 3:
            tip.rules[0].note = "edited while it is asked"

    threads = [threading.Thread(target=ask, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_a_forked_process_has_threads_of_its_own(tip):
    import os

    many = np.linspace(0, 10, 100_000)
    expected = tip(many, many)
    child = os.fork()
    if child == 0:
        os._exit(0 if np.array_equal(tip(many, many), expected) else 1)
    assert os.waitpid(child, 0)[1] == 0


def test_ctrl_c_ends_an_evaluation():
    code = """
import signal, sys, threading, time, os
import numpy as np, flagred
model = flagred.loads(sys.stdin.read())
many = np.linspace(0, 10, 60_000_000)
threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
begun = time.monotonic()
try:
    model(many, many, threads=1)
except KeyboardInterrupt:
    sys.exit(0 if time.monotonic() - begun < 3 else 4)
sys.exit(5)
"""
    done = subprocess.run([sys.executable, "-c", code], input=TIP, text=True, timeout=60)
    assert done.returncode == 0


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.text(), st.binary().map(lambda data: data.decode("latin-1"))))
def test_any_text_is_read_or_refused(text):
    try:
        flagred.loads(text)
    except flagred.RuleSetError as error:
        assert error.findings


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_damaged_rule_sets_are_read_or_refused(data):
    at = data.draw(st.integers(0, len(TIP)))
    removed = data.draw(st.integers(0, 12))
    text = TIP[:at] + data.draw(st.text(max_size=5)) + TIP[at + removed :]
    try:
        model = flagred.loads(text)
        model(*[1.0] * len(model.inputs))
    except (flagred.RuleSetError, flagred.DataError):
        pass


COMMENTED = """# Why: the manual, page 3.
fuzzy: 1
name: fan # short
inputs:
  heat: {range: [0, 40], partition: {cool: 5, hot: 35}} # sensor 1
outputs:
  speed: {range: [0, 9], partition: [slow, fast]}
rules:
  - IF heat IS cool THEN speed IS slow # quiet
  - IF heat IS hot THEN speed IS fast # loud
"""


def test_a_file_that_is_not_edited_is_saved_as_it_was(tmp_path):
    path = tmp_path / "fan.yaml"
    for text in (COMMENTED, COMMENTED.replace("\n", "\r\n")):
        path.write_bytes(text.encode())
        flagred.load(path).save(tmp_path / "again.yml")
        assert (tmp_path / "again.yml").read_bytes() == text.encode()


def test_edits_keep_comments():
    fan = flagred.loads(COMMENTED)
    fan.rules[1].weight = 0.5
    fan.inputs["heat"].range = (0, 45)
    fan.inputs["heat"].partition = {"cool": 6, "hot": 36}
    fan.rules.append("IF heat IS very hot THEN speed IS fast")
    fan.description = "cools the server room"
    text = fan.to_text()
    expected = COMMENTED.replace("IS fast #", "IS fast WITH 0.5 #").replace("[0, 40]", "[0, 45]")
    expected = expected.replace("cool: 5, hot: 35", "cool: 6, hot: 36")
    expected += "  - IF heat IS very hot THEN speed IS fast\n"
    for line in expected.splitlines():
        assert line in text.splitlines(), text
    assert "description: cools the server room" in text
    assert flagred.loads(text) == fan
    del fan.rules[0]
    assert "# quiet" not in fan.to_text() and "# loud" in fan.to_text()


@pytest.mark.parametrize("ending", ["fis", "fll", "fcl", "fml", "xml", "yaml"])
def test_the_ending_chooses_the_format(tip, ending, tmp_path):
    path = tmp_path / f"tip.{ending}"
    tip.save(path)
    begins = {"fis": "[System]", "fll": "Engine:", "fcl": "FUNCTION_BLOCK", "yaml": "fuzzy: 1"}.get(ending, "<?xml")
    text = path.read_text()
    assert text.startswith(begins)
    again = flagred.load(path)
    assert again(8, 9) == pytest.approx(tip(8, 9), rel=1e-3)
    again.save(tmp_path / f"again.{ending}")
    assert (tmp_path / f"again.{ending}").read_text() == text


def test_formats_are_those_of_the_command(tip, tmp_path):
    command = os.environ.get("FLAGRED_COMMAND")
    if command is None or shutil.which(command) is None:
        pytest.skip("FLAGRED_COMMAND names no command `flagred`")
    source = tmp_path / "tip.yaml"
    tip.save(source)
    for format in ("fis", "fll", "fcl", "fml", "rust", "c"):
        run = subprocess.run([command, "export", f"--{format}", source], capture_output=True, text=True)
        assert run.stdout == tip.to_text(format), run.stderr
    for language in ("rust", "c", "lua"):
        run = subprocess.run([command, "export", f"--{language}", "flagred"], capture_output=True, text=True)
        assert run.stdout == flagred.Profile("flagred").to_code(language), run.stderr


def test_code_for_firmware_is_saved_by_its_ending(tip, tmp_path):
    tip.save(tmp_path / "tip.c")
    assert "flagred.h" in (tmp_path / "tip.c").read_text()
    tip.save(tmp_path / "tip.rs")
    assert "pub fn" in (tmp_path / "tip.rs").read_text()
    with pytest.raises(flagred.DataError, match="cannot be exported in the language `python`"):
        flagred.Profile().to_code("python")
    with pytest.raises(flagred.DataError, match="exported code supports only one"):
        flagred.Profile("flagred-battery").to_code("lua")


def test_unsupported_features_of_a_format_are_refused_or_dropped_with_a_warning(tmp_path):
    lost = flagred.loads(COMMENTED.replace("name: fan # short", "name: fan")
                         .replace("partition: [slow, fast]}", "partition: [slow, fast], when_no_rule_fires: previous}"))
    refusing = []
    for format in ("fis", "fll", "fcl", "fml"):
        try:
            lost.to_text(format)
        except flagred.RuleSetError:
            refusing.append(format)
            with pytest.warns(UserWarning):
                lost.to_text(format, lossy=True)
    assert "fis" in refusing
    with pytest.raises(flagred.RuleSetError):
        lost.save(tmp_path / "lost.fis")
    assert not (tmp_path / "lost.fis").exists()
    with pytest.raises(flagred.DataError, match="the extensions are `.yaml`"):
        lost.save(tmp_path / "lost.txt")
    with pytest.raises(flagred.DataError, match="`doc` is not a format"):
        lost.to_text("doc")


def test_texts_come_as_bytes_and_from_open_files(tmp_path):
    fan = flagred.loads(COMMENTED)
    assert flagred.loads(COMMENTED.encode()) == fan
    path = tmp_path / "fan.yaml"
    path.write_text(COMMENTED)
    for mode in ("r", "rb"):
        with open(path, mode) as file:
            assert flagred.load(file) == fan
    with pytest.raises(flagred.RuleSetError, match="not UTF-8: byte 1"):
        flagred.loads(b"a\xff")
    with pytest.raises(flagred.DataError, match="`int` is not a file"):
        flagred.load(3)
    with pytest.raises(flagred.DataError, match="`load` reads files"):
        flagred.loads(path)


def test_rules_are_counted_from_one(tip):
    assert repr(tip.rules[0]).startswith("Rule(1: IF service IS poor")
    assert tip.rules[2].number == 3
    assert repr(tip.rules).splitlines()[2].startswith("3: ")
    assert tip.evaluate(8, 9).dominant_rule == 3


def test_degrees_of_a_term(tip):
    good = tip.inputs["service"]["good"]
    assert good(2.5) == 0.5 and isinstance(good(2.5), float)
    assert good([[0, 2.5], [5, 10]]).tolist() == [[0, 0.5], [1, 0]]
    assert math.isnan(good(None))
    # Values outside the range are clamped, as in an evaluation.
    assert tip.inputs["service"]["excellent"](99) == tip.inputs["service"]["excellent"](10) == 1
    why = tip.explain(3.25, 9)
    assert why.inputs[0].terms == {term: tip.inputs["service"][term](3.25) for term in tip.inputs["service"]}
    assert tip.outputs["tip"]["medium"](15) == 1
    assert len(tip.inputs["service"]) == 3 and "good" in tip.inputs["service"]
    with pytest.raises(KeyError, match="its terms are `poor`, `good`, `excellent`"):
        tip.inputs["service"]["god"]


def test_surface(tip):
    assert str(tip.surface())[:4] == "<svg"
    with pytest.raises(flagred.DataError, match="two axes"):
        tip.surface(food=3)
    pyplot = pytest.importorskip("matplotlib.pyplot")
    figure = pyplot.figure()
    ax = tip.surface(figure.add_subplot(projection="3d"), points=11)
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()) == ("service", "food", "tip")
    with pytest.raises(flagred.DataError, match="the axes are flat"):
        tip.surface(figure.add_subplot())


def test_help_fits_on_ten_screens_and_modules_describe_the_rest():
    assert len(pydoc.plain(pydoc.render_doc(flagred)).splitlines()) <= 10 * 62
    described = {*flagred.__all__, *flagred.learning.__all__, *flagred.errors.__all__, *flagred.evaluation.__all__}
    assert {name for name in vars(flagred) if name[0].isupper() or callable(getattr(flagred, name))} <= described | {"Profile"}
    for name in flagred.types.__all__:
        assert isinstance(getattr(flagred.types, name), type)


TYPE2 = """
fuzzy: 1
name: dinner
inputs: {food: {range: [0, 10], partition: [bad, good], blur: 0.1}}
outputs:
  tip: {range: [0, 30], partition: [small, large], blur: 0.05}
  wine: {range: [0, 1], defuzzifier: weighted_average, terms: {red: {constant: 0}, white: {constant: 1}}}
rules:
  - IF food IS bad THEN tip IS small AND wine IS red
  - IF food IS good THEN tip IS large AND wine IS white
"""


def test_outcomes_of_type2_rule_sets_have_an_interval():
    model = flagred.loads(TYPE2)
    outcome = model.evaluate(food=6)["tip"]
    assert outcome.low < outcome.value < outcome.high
    assert outcome.value == pytest.approx((outcome.low + outcome.high) / 2)
    assert f"low={outcome.low}" in repr(outcome)
    assert pickle.loads(pickle.dumps(outcome)) == outcome
    outcomes = model.evaluate(np.array([6.0, np.nan]))["tip"]
    assert (outcomes.low[0], outcomes.high[0]) == (outcome.low, outcome.high)
    assert np.isnan(outcomes.low[1])
    # Without type-2 terms, both ends are the value.
    ordinary = flagred.loads(TYPE2.replace(", blur: 0.1", "").replace(", blur: 0.05", "")).evaluate(food=6)["tip"]
    assert ordinary.low == ordinary.value == ordinary.high
    assert "low" not in repr(ordinary)


def test_frames_have_columns_for_the_ends():
    model = flagred.loads(TYPE2)
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    expected = model.evaluate(food=6)
    for frame in (pandas.DataFrame({"food": [6.0]}), polars.DataFrame({"food": [6.0]})):
        result = model.evaluate(frame)
        assert list(result.columns)[:3] == ["tip", "tip_low", "tip_high"]
        assert result["tip_low"][0] == expected["tip"].low
        assert result["wine_high"][0] == expected["wine"].high


def test_uncertain_inputs():
    model = flagred.loads(TYPE2)
    tip = model.evaluate_interval(food=(5.5, 6.5))["tip"]
    for food in np.linspace(5.5, 6.5, 21):
        outcome = model.evaluate(food=food)["tip"]
        assert tip.low <= outcome.low and outcome.high <= tip.high
    assert not tip.may_be_undefined and not tip.clamped
    assert pickle.loads(pickle.dumps(tip)) == tip
    assert model.evaluate_interval((5.5, 6.5))["tip"] == model.evaluate_interval({"food": (5.5, 6.5)})["tip"] == tip
    point = model.evaluate_interval(food=6)["tip"]
    assert point.low == model.evaluate(food=6)["tip"].low
    with pytest.raises(flagred.DataError, match="the interval of input `food` ends below its start"):
        model.evaluate_interval(food=(6, 5))
    with pytest.raises(flagred.DataError, match="'x' is not an interval"):
        model.evaluate_interval(food="x")
