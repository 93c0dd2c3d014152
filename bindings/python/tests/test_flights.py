"""Flights: logs, assessments, a monitor."""

import io
import json
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import flagred

CSV = "t_s,motor1,motor2,motor3,motor4,in_air\n" + "".join(
    f"{i / 50},{'0,1,0.05,1' if i > 600 else '0.4,0.4,0.41,0.41'},1\n" for i in range(1500)
)


@pytest.fixture(scope="module")
def flight(steady):
    return flagred.read_log(steady)


def test_a_log_from_a_path_bytes_and_a_file(steady, flight):
    for log in (str(steady), steady.read_bytes(), io.BytesIO(steady.read_bytes())):
        again = flagred.read_log(log)
        assert np.array_equal(again.commands, flight.commands, equal_nan=True)
    with steady.open("rb") as file:
        assert flagred.read_log(file).name == str(steady)


def test_the_content_of_a_log(flight):
    assert (flight.format, flight.vehicle.frame, len(flight.motors)) == ("ArduPilot DataFlash", "QUAD/X", 4)
    assert flight.range.unit == "us" and flight.range.high == 2000
    assert flight.in_air.duration_s == pytest.approx(129.14, abs=0.01)
    assert flight.in_air.spans[0].start_s < flight.in_air.spans[0].end_s
    assert flight.report.truncated and not flight.report.is_clean
    assert flight.geometry.basis == "declared" and len(flight.geometry.factors) == 4
    assert flight.modes[0].t_s <= flight.modes[-1].t_s
    assert all(parameter.name == name for name, parameter in flight.parameters.items()) and flight.parameters
    assert flight.commands.shape == flight.raw_commands.shape == (len(flight.t_s), 4)
    assert np.nanmin(flight.commands) >= 0 and np.nanmax(flight.commands) <= 1
    assert (np.diff(flight.t_s) >= 0).all()
    table = flight.commands_table
    assert table.keys() == ["t_s", "motor1", "motor2", "motor3", "motor4"]
    assert np.array_equal(table["motor3"], flight.commands[:, 2], equal_nan=True)


def test_the_identity_of_a_vehicle(flight):
    assert flight.vehicle.system_id == 1
    named = flagred.read_log(("# vehicle_id: seven\n# boot_count: 812\n" + CSV).encode()).vehicle
    assert (named.id, named.id_source, named.boot_count) == ("seven", "header vehicle_id", 812)
    assert flagred.read_log(CSV.encode()).vehicle[5:] == (None, None, None, None)


def test_signals(flight):
    roll = flight.signals["roll_deg"]
    assert (roll.unit, roll.source) == ("deg", "ATT.Roll") and len(roll) == len(roll.values)
    assert roll.rate_hz == pytest.approx(1 / np.median(np.diff(roll.t_s)), rel=0.05)
    assert np.array_equal(roll.base["roll_deg"], roll.values, equal_nan=True)
    assert "roll_deg" in flight.signals and "wind" not in flight.signals
    some = flagred.read_log(CSV.encode(), signals=[])
    assert len(some.signals) == 0 and some.commands.shape == (1500, 4)


def test_a_given_range_is_used_where_the_log_has_none(steady):
    rows = "".join(f"{i / 50},1500,1510,1490,1500,1\n" for i in range(1000))
    pulses = ("t_s,pwm1,pwm2,pwm3,pwm4,in_air\n" + rows).encode()
    flight = flagred.read_log(pulses, range=(1100, 1900))
    assert (flight.range.low, flight.range.high, flight.range.source) == (1100, 1900, "given by the user")
    assert flight.assumed == ("commands from 1100 to 1900 us, given by the user",)
    assert flagred.assess(pulses).verdict == "NA"
    assert flagred.assess(pulses, range=(1100, 1900)).verdict == "GOOD"
    with pytest.raises(ValueError, match="expected two pulse widths from 500 to 2500 us"):
        flagred.read_log(pulses, range=(1900, 1100))
    with pytest.raises(ValueError, match="`read_log"):
        flagred.assess(flight, range=(1100, 1900))
    with pytest.raises(flagred.LogError, match="reports its own range"):
        flagred.read_log(steady, range=(1100, 1900))


def test_an_assessment_is_that_of_the_command_line(flight):
    assessment = flagred.assess(flight)
    document = json.loads(assessment.to_json())
    assert document["schema"] == "flagred.assess/1"
    assert assessment.verdict == document["verdict"] == "GOOD"
    assert assessment.reason is None and str(assessment).startswith("GOOD ")
    assert assessment.summary.risk_max.value_pct == document["summary"]["risk_max"]["value_pct"]
    steps = assessment.steps
    assert len(steps) == len(document["steps"]) > 1000
    for name in ("risk", "elevated_risk", "coverage", "margin"):
        expected = [np.nan if step[name] is None else step[name] for step in document["steps"]]
        assert np.array_equal(steps[name], expected, equal_nan=True), name
    for name, first in document["steps"][500]["inputs"].items():
        assert steps[f"input_{name}"][500] == first
    rules = [np.nan if step["dominant_rule"] is None else step["dominant_rule"] for step in document["steps"]]
    assert np.array_equal(steps["dominant_rule"], rules, equal_nan=True)


def test_an_input_has_a_column_beside_that_of_the_summary():
    assessment = flagred.assess(CSV.encode(), "flagred-paper")
    step = json.loads(assessment.to_json())["steps"][-1]
    assert assessment.steps["spread"][-1] == step["spread"]
    assert assessment.steps["input_spread"][-1] == step["inputs"]["spread"]


def test_findings_and_the_report():
    assessment = flagred.assess(CSV.encode(), "flagred-paper")
    assert assessment.verdict == "FAIL" and assessment.profile.name == "flagred-paper"
    worst = assessment.findings[0]
    document = json.loads(assessment.to_json())["findings"][0]
    assert (worst.severity, worst.from_s, worst.value_pct) == ("FAIL", document["from_s"], document["value_pct"])
    assert worst.cause.rule == document["cause"]["rule"]
    assert (worst.code, worst.text, worst.advice) == (document["code"], document["text"], document["advice"])
    assert str(worst).endswith(f" s: {worst.text} {worst.advice}")
    assert worst.motor.number == document["motor"]["number"]
    html = assessment.html()
    assert html.startswith("<!DOCTYPE html>") and "FAIL" in html and "<path" in html
    assert assessment.svg().startswith("<svg ")
    assert assessment._repr_html_().startswith("<iframe srcdoc=")
    assert len(flagred.assess(CSV.encode(), step_s=None).steps) == 0
    with pytest.raises(flagred.DataError, match="`step_s` is 0"):
        flagred.assess(CSV.encode(), step_s=0)


def test_a_missing_verdict_has_a_reason():
    assessment = flagred.assess(b"t_s,motor1,motor2,motor3,motor4\n0,0.4,0.4,0.5,0.5\n")
    assert assessment.verdict == "NA" and assessment.reason and assessment.summary.risk_max is None
    assert "no verdict" in str(assessment)


def test_a_file_that_is_not_a_log(tmp_path):
    with pytest.raises(flagred.LogError, match="is empty"):
        flagred.read_log(b"")
    with pytest.raises(flagred.LogError, match="PNG picture"):
        flagred.read_log(b"\x89PNG\r\n\x1a\n" + bytes(100))
    with pytest.raises(FileNotFoundError) as error:
        flagred.read_log(tmp_path / "none.bin")
    assert error.value.filename == str(tmp_path / "none.bin")
    with pytest.raises(OSError):
        flagred.read_log(tmp_path)


def test_profiles(tmp_path):
    profile = flagred.Profile()
    assert profile.name == "flagred" and "at_limit" in profile.inputs
    again = pickle.loads(pickle.dumps(profile))
    assert (again.text, again.rules_text, again.inputs) == (profile.text, profile.rules_text, profile.inputs)
    file = tmp_path / "mine.yaml"
    file.write_text(flagred.Profile("flagred-paper").text, encoding="utf-8")
    assert flagred.Profile(str(file)).inputs == ["margin", "spread"]
    file.write_text(file.read_text(encoding="utf-8").replace("\ninputs:", "\ninptus:"), encoding="utf-8")
    with pytest.raises(flagred.RuleSetError) as error:
        flagred.Profile(str(file))
    assert str(file) in str(error.value)
    with pytest.raises(FileNotFoundError, match="built-in profiles are flagred, flagred-paper, flagred-battery"):
        flagred.Profile("none")
    file.write_text(flagred.loads(profile.rules_text).to_yaml(), encoding="utf-8")
    with pytest.raises(flagred.DataError, match="is a rule set, not a profile"):
        flagred.Profile(str(file))


def test_a_monitor_agrees_with_the_assessment():
    flight = flagred.read_log(CSV.encode())
    assessment = flagred.assess(flight, "flagred-paper", step_s=None)
    monitor = flagred.Monitor("flagred-paper")
    levels = []
    for t_s, commands in zip(flight.t_s, flight.commands):
        update = monitor.push(float(t_s), commands)
        assert (update.risk is None) == (update.unknown is not None)
        levels.append(update.level)
    assert levels[300] == "GOOD" and levels[-1] == "FAIL"
    followed = monitor.finish()
    assert followed.verdict == assessment.verdict == "FAIL"
    assert followed.findings[0].from_s == assessment.findings[0].from_s
    assert followed.summary.risk_max == assessment.summary.risk_max
    assert monitor.finish() is None
    assert monitor.push(0.0, [0.5] * 4, in_air=False).unknown == "on the ground"
    with pytest.raises(flagred.DataError, match="expected 4 commands, but 3 were given"):
        monitor.push(1.0, [0.5] * 3)


@pytest.mark.parametrize("unknown", [float("nan"), None])
def test_the_risk_is_unknown_without_the_command_of_a_motor(unknown):
    monitor = flagred.Monitor("flagred-paper")
    for i in range(1000):
        update = monitor.push(i * 0.04, [1.0, 0.0, 1.0, unknown if i >= 250 else 0.0])
        assert i < 250 or (update.risk is None and update.unknown == "the command of motor 4 is unknown")
    assert update.level is None
    monitor = flagred.Monitor("flagred-paper")
    for i in range(1000):
        monitor.push(i * 0.04, [0.5, 0.5, 0.5, unknown if i >= 250 else 0.5])
    followed = monitor.finish()
    assert followed.verdict == "NA"
    assert "the command of motor 4 is unknown in the air from 10.0 to 40.0 s" in followed.reason


def test_a_monitor_clamps_rounding_and_refuses_other_units():
    def levels(command):
        monitor = flagred.Monitor("flagred-paper")
        return [monitor.push(i * 0.04, [command, 0.0, command, 0.0]).level for i in range(1000)]

    assert levels(1.0000001) == levels(1.0) and levels(1.0)[-1] == "FAIL"
    monitor = flagred.Monitor("flagred-paper")
    for command in [1500, 50.0, -1.0, float("inf")]:
        with pytest.raises(flagred.DataError, match="the command of motor 2 is `.*`, but a command is a fraction from 0 to 1"):
            monitor.push(0.0, [0.5, command, 0.5, 0.5])
    # A refused sample leaves no state behind.
    fresh = flagred.Monitor("flagred-paper")
    assert [monitor.push(i * 0.04, [0.5] * 4).risk for i in range(500)] == [fresh.push(i * 0.04, [0.5] * 4).risk for i in range(500)]


@settings(max_examples=200, deadline=None)
@given(st.one_of(st.binary(max_size=2000), st.binary(max_size=200).map(lambda data: b"\xa3\x95\x80\x80" + data)))
def test_any_bytes_are_read_or_refused(data):
    try:
        flagred.assess(data).html()
    except flagred.LogError:
        pass


@settings(max_examples=30, deadline=None)
@given(st.data())
def test_damaged_logs_are_read(steady, data):
    log = bytearray(steady.read_bytes()[: data.draw(st.integers(0, 300_000))])
    for _ in range(data.draw(st.integers(0, 20)) if log else 0):
        log[data.draw(st.integers(0, len(log) - 1))] = data.draw(st.integers(0, 255))
    try:
        flight = flagred.read_log(bytes(log))
    except flagred.LogError:
        return
    assert flight.commands.shape == (len(flight.t_s), len(flight.motors))
    assert flagred.assess(flight).verdict in ("GOOD", "WARN", "FAIL", "NA")


def test_a_flight_is_pickled_with_the_bytes_of_its_log(steady, flight, tmp_path):
    part = flagred.read_log(steady, signals=["roll_deg"])
    for one in (flight, part, flagred.read_log(steady.read_bytes())):
        again = pickle.loads(pickle.dumps(one))
        assert type(again) is flagred.types.Flight
        assert again._data == one._data and again.name == one.name
        assert np.array_equal(again.raw_commands, one.raw_commands, equal_nan=True)
        assert list(again.signals) == list(one.signals)
    log = tmp_path / "log.csv"
    log.write_text("t_s,pwm1,pwm2,pwm3,pwm4\n0,1500,1500,1500,1500\n")
    ranged = flagred.read_log(log, range=(1000, 2000))
    again = pickle.loads(pickle.dumps(ranged))
    assert again.range == ranged.range
    pickled = pickle.dumps(ranged)
    log.write_text("t_s,pwm1,pwm2,pwm3,pwm4\n0,1500,1500,1500,1500\n1,1,1,1,1\n")
    with pytest.raises(flagred.DataError, match="changed after it was read"):
        pickle.dumps(ranged)
    log.unlink()
    with pytest.raises(FileNotFoundError, match="pickled with the bytes"):
        pickle.dumps(ranged)
    assert pickle.loads(pickled).commands.tolist() == [[0.5, 0.5, 0.5, 0.5]]


def test_an_assessment_is_pickled(steady):
    for log, profile in ((CSV.encode(), "flagred-paper"), (steady, "flagred")):
        one = flagred.assess(log, profile, step_s=0.5)
        again = pickle.loads(pickle.dumps(one))
        assert type(again) is flagred.types.Assessment
        assert (again.verdict, again.findings, again.summary) == (one.verdict, one.findings, one.summary)
        assert str(again) == str(one)
        assert again.profile.name == one.profile.name and again.flight.name == one.flight.name
        assert again.to_json() == one.to_json() and again.html() == one.html() and again.svg() == one.svg()
        assert {name: again.steps[name].tolist() for name in again.steps}.keys() == {*one.steps}
        for name in one.steps:
            assert np.array_equal(again.steps[name], one.steps[name], equal_nan=True)
        assert pickle.loads(pickle.dumps(again)).verdict == one.verdict


def test_many_logs_are_assessed_by_processes(steady):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        found = list(pool.map(flagred.assess, [str(steady), str(steady)]))
    assert [one.verdict for one in found] == ["GOOD", "GOOD"]
    assert len(found[0].steps) == len(flagred.assess(steady).steps)


def test_a_table_is_pickled():
    steps = flagred.assess(CSV.encode(), "flagred-paper").steps
    again = pickle.loads(pickle.dumps(steps))
    pyarrow = pytest.importorskip("pyarrow")
    assert pyarrow.table(again).equals(pyarrow.table(steps), check_metadata=True)
    assert pyarrow.table(steps)["dominant_rule"].null_count > 0


@given(st.sets(st.integers(0, 899), max_size=4), st.integers(0, 1000))
@settings(max_examples=10, deadline=None)
def test_a_monitor_is_pickled_at_any_time(moments, seed):
    random = np.random.default_rng(seed)
    profile = flagred.Profile("flagred-battery")
    signals = ["battery_remaining_pct"]
    one, other = (flagred.Monitor(profile, signals=signals, step_s=0.1) for _ in range(2))
    for i in range(900):
        if i in moments:
            other = pickle.loads(pickle.dumps(other))
        spread = 0.02 if i < 500 else 0.5
        commands = (0.5 + random.uniform(-spread, spread, 4)).tolist()
        battery = {"battery_remaining_pct": None if i % 90 == 0 else 100 - i / 10}
        updates = [monitor.push(i * 0.04, commands, in_air=True, signals=battery) for monitor in (one, other)]
        assert repr(updates[0]) == repr(updates[1]) and updates[0].risk == updates[1].risk
        assert one.ended() == other.ended()
    assert pickle.dumps(one) == pickle.dumps(other)
    ended, again = one.finish(), other.finish()
    assert ended[:4] == again[:4] and len(ended.steps) > 0
    for name in ended.steps:
        assert np.array_equal(ended.steps[name], again.steps[name], equal_nan=True)
    carried = pickle.loads(pickle.dumps(ended))
    assert carried[:4] == ended[:4] and len(carried.steps) == len(ended.steps)
    assert pickle.loads(pickle.dumps(one)).finish() is None


def test_a_pickle_of_another_version_is_refused():
    monitor = flagred.Monitor("flagred-paper")
    monitor.push(0.0, [0.5] * 4)
    rebuild, (*made_of, (motors, state)) = monitor.__reduce__()
    version = len(b"flagred state ")
    newer = state[:version] + b"\xff" + state[version + 1 :]
    with pytest.raises(flagred.DataError, match="the state has version 255, but this version of flagred reads version"):
        rebuild(*made_of, (motors, newer))
    with pytest.raises(flagred.DataError, match="damaged"):
        rebuild(*made_of, (motors, state[:-9]))
    with pytest.raises(flagred.DataError, match="another profile, rule set or craft"):
        rebuild(flagred.Profile("flagred"), *made_of[1:], (motors, state))


def test_a_moment_lists_the_rules_that_fired():
    assessment = flagred.assess(CSV.encode(), "flagred-paper")
    moment = assessment.moment(20.04)
    assert moment["t_s"] == 20.04
    t_s = assessment.steps["t_s"]
    place = np.searchsorted(t_s, 20.04, side="right") - 1
    assert moment["step"]["t_s"] == t_s[place]
    assert moment["step"]["risk"] == assessment.steps["risk"][place]
    assert moment["rules"][0]["rule"] == moment["step"]["dominant_rule"] == assessment.steps["dominant_rule"][place]
    assert {one["name"] for one in moment["inputs"]} == {"margin", "spread"}
    assert assessment.moment(-5)["step"] is None


def test_signals_are_arrays_and_frames(flight):
    roll, height = flight.signals["roll_deg"], flight.signals["altitude_m"]
    assert np.array_equal(np.asarray(roll), roll.values, equal_nan=True)
    assert np.asarray(roll, dtype=np.float32).dtype == np.float32
    table = flight.signals.table(["altitude_m", "roll_deg"])
    assert list(table) == ["t_s", "altitude_m", "roll_deg"]
    assert np.array_equal(table["altitude_m"], height.values, equal_nan=True)
    for i in (0, 17, len(height) - 1):
        before = roll.t_s <= height.t_s[i]
        expected = roll.values[before][-1] if before.any() else np.nan
        assert np.array_equal(table["roll_deg"][i], expected, equal_nan=True)
    early = flight.signals.table("roll_deg", t_s=[roll.t_s[0] - 1, roll.t_s[0]])
    assert np.isnan(early["roll_deg"][0]) and early["roll_deg"][1] == roll.values[0]
    with pytest.raises(flagred.DataError, match="no signal `pitch`"):
        flight.signals.table(["pitch"])
    pandas = pytest.importorskip("pandas")
    assert pandas.DataFrame(roll).shape == (len(roll), 1)
    assert len(pandas.DataFrame(table)) == len(height)
    polars = pytest.importorskip("polars")
    assert polars.DataFrame(roll).columns == ["t_s", "roll_deg"]


def test_other_files_are_reported_with_a_remedy(steady):
    with pytest.raises(flagred.DataError, match=r"`list` is not a flight log\n  help: take one log at a time: `\[flagred"):
        flagred.assess([steady])
    with pytest.raises(flagred.DataError, match="`int` is not a flight log\n  help: give a path"):
        flagred.read_log(3)
    monitor = flagred.Monitor("flagred-paper")
    monitor.push(0, [0.5, 0.5, 0.5, 0.5])
    with pytest.raises(flagred.DataError, match="expected 4 commands, but 3 were given"):
        monitor.push(0.1, [0.5, 0.5, 0.5])
    for bad in (1500, -3, 1.6):
        with pytest.raises(flagred.DataError, match=f"the command of motor 2 is `{bad}`, but a command is a fraction"):
            monitor.push(0.1, [0.5, bad, 0.5, 0.5])
