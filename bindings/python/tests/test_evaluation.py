"""Profiles on many flights, compared with the command line."""

import gzip
import json
import os
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import flagred
from conftest import ROOT
from flagred.evaluation import Areas, LeftOutFile, Warnings

COMMAND = os.environ.get("FLAGRED_COMMAND")
HEADER = "t_s,motor1,motor2,motor3,motor4,roll_des_deg,roll_deg,pitch_des_deg,pitch_deg,in_air\n"


def log(vehicle: str, kind: str, upset_s: float | None) -> bytes:
    """A minute in the air. Some seconds before the upset, the motors reach their limits; then the vehicle rolls over."""
    lines = [f"# vehicle: {vehicle}\n# kind: {kind}\n", HEADER]
    for i in range(1600):
        t_s = i / 25
        since_s = -100.0 if upset_s is None else t_s - upset_s
        high, low = (1, 0) if since_s > -4 else (0.552, 0.548)
        roll = min(max(since_s * 100, 0.1), 170)
        lines.append(f"{t_s},{high},{low},{high},{low},0,{roll},0,0,{int(1 <= t_s <= 61)}\n")
    return "".join(lines).encode()


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("flights")
    (folder / "deep").mkdir()
    (folder / "a.csv").write_bytes(log("board 1", "calm", None))
    (folder / "b.csv.gz").write_bytes(gzip.compress(log("board 1", "calm", None)))
    (folder / "deep" / "c.csv").write_bytes(log("board 2", "gusts", 40))
    (folder / "deep" / "d.csv").write_bytes(log("board 3", "gusts", 31))
    (folder / "notes.txt").write_text("took off at noon\n")
    return folder


@pytest.fixture(scope="module")
def evaluation(folder) -> flagred.types.Evaluation:
    return flagred.evaluate(folder)


def command(*arguments: object) -> str:
    """The output of `flagred validate`."""
    if COMMAND is None or shutil.which(COMMAND) is None:
        pytest.skip("FLAGRED_COMMAND names no command `flagred`")
    done = subprocess.run([COMMAND, "validate", *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_logs_are_evaluated_as_by_the_command_line(folder, evaluation):
    assert evaluation.to_dict() == json.loads(command("--json", folder))
    assert str(evaluation) == command(folder)
    steady = ROOT / "examples/flights"
    assert flagred.evaluate(steady).to_dict() == json.loads(command("--json", steady))
    profile = ROOT / "rules/profiles/multirotor.yaml"
    ours = flagred.evaluate([folder / "a.csv", folder / "deep"], profile, horizon_s=3)
    theirs = command("--json", "--horizon", 3, "--profile", profile, folder / "a.csv", folder / "deep")
    assert ours.to_dict() == json.loads(theirs)
    assert flagred.evaluate(folder, "flagred", threads=1).to_json() == evaluation.to_json()


def test_the_content_of_an_evaluation(evaluation):
    assert (evaluation.cases, evaluation.horizon_s, len(evaluation.flights)) == ("steps", 5, 4)
    assert list(evaluation.estimators)[:2] == ["flagred", "flagred-paper"] and len(evaluation.estimators) == 11
    assert repr(evaluation).startswith("Evaluation(11 estimators on ")
    [left_out] = evaluation.left_out
    assert isinstance(left_out, LeftOutFile) and left_out.file.endswith("notes.txt")
    assert "not a flight log" in left_out.reason and "notes.txt" not in left_out.reason
    document = {data["name"]: data for data in evaluation.to_dict()["estimators"]}
    for name, of in evaluation.estimators.items():
        told = document[name]
        for areas, data in [(of.areas, told), (of.quiet, told["quiet"]), (of.onset, told["onset"])]:
            assert areas._asdict() == {
                key: tuple(data[key]) if isinstance(data[key], list) else data[key] for key in Areas._fields
            }
        assert list(of.by_vehicle) == ["board 1", "board 2", "board 3"] and list(of.by_kind) == ["calm", "gusts"]
        assert (of.warnings is None) == (of.alarms is None) == (of.reliability is None) == ("flagred" not in name)
    flagred_ = evaluation.estimators["flagred"]
    assert flagred_.areas.auc > 0.8 and flagred_.areas.auc_interval[0] <= flagred_.areas.auc
    assert isinstance(flagred_.warnings, Warnings) and flagred_.warnings.episodes == 2
    assert flagred_.warnings_by_kind["calm"].episodes == 0
    assert sum(band.cases for band in flagred_.reliability) == flagred_.areas.cases
    assert flagred_.alarms.ordinary_flights.verdicts == {"GOOD": 2, "WARN": 0, "FAIL": 0}
    assert flagred_.alarms.upsets.before == 2 and flagred_.alarms.by_kind["gusts"].upsets.assessed == 2
    upset = evaluation.flights[2]
    assert (upset.vehicle, upset.kind) == ("board 2", "gusts") and upset.upsets_s[0] == pytest.approx(40.6, abs=0.1)
    said = upset.profiles["flagred"]
    assert said.verdict == "FAIL" and said.alarms[0].from_s < 40
    assert said.episodes[0].lead_s == pytest.approx(said.episodes[0].from_s - said.episodes[0].warned_s)
    assert not said.warnings[0].is_false


def test_scores_and_curves_are_columns(evaluation):
    scores = evaluation.scores
    assert scores.keys()[:5] == ["flight", "t_s", "critical", "quiet", "onset"]
    assert scores.keys()[5:] == list(evaluation.estimators)
    steps = [flight.steps for flight in evaluation.flights]
    assert len(scores) == sum(steps) and np.bincount(scores["flight"].astype(int)).tolist() == steps
    assert np.all(np.diff(scores["t_s"][: steps[0]]) == 0.5)
    critical = scores["critical"] == 1
    assert critical.sum() == sum(flight.critical for flight in evaluation.flights) > 0
    for name in ("flagred", "spread"):
        risk, areas = scores[name], evaluation.estimators[name].areas
        assert np.isnan(risk).sum() == areas.unknown
        known = ~np.isnan(risk)
        above = risk[known & critical][:, None] - risk[known & ~critical][None, :]
        assert areas.auc == pytest.approx(np.mean((above > 0) + 0.5 * (above == 0)), abs=1e-12)
    false_rate, true_rate = evaluation.roc("flagred")
    assert (false_rate[0], true_rate[0]) == (0, 0) and (false_rate[-1], true_rate[-1]) == (1, 1)
    assert evaluation.roc("true_wind")[0].size == 0
    with pytest.raises(flagred.DataError, match="no estimator `flagged`"):
        evaluation.roc("flagged")
    polars = pytest.importorskip("polars", reason="polars is not installed")
    assert polars.DataFrame(scores)["true_wind"].null_count() == len(scores)


def test_the_page_and_the_picture(evaluation):
    html = evaluation.html()
    assert html.startswith("<!DOCTYPE html>") and "</html>" in html and evaluation.svg() in html
    for said in ("verdicts by vehicle", "warnings of flagred-paper", "board 3", "1 file left out: is a text file"):
        assert said in html, said
    assert html.count("<table>") == str(evaluation).count("\n\n") > 5
    assert evaluation._repr_html_().startswith("<iframe srcdoc=")


def test_flights_bytes_and_files(folder):
    path = folder / "deep/c.csv"
    flight = flagred.read_log(path)
    expected = flagred.evaluate(path)
    assert flagred.evaluate(flight).to_json() == expected.to_json()
    assert flagred.evaluate([str(path)]).to_json() == expected.to_json()
    with path.open("rb") as file:
        assert flagred.evaluate(file).to_json() == expected.to_json()
    several = flagred.evaluate([path.read_bytes(), flight])
    assert [flight.file for flight in several.flights] == ["<bytes>", str(path)]


def test_logs_that_cannot_be_used(folder, tmp_path):
    good, notes = folder / "deep/c.csv", folder / "notes.txt"
    with pytest.raises(flagred.LogError, match="notes.txt` is .*not a flight log"):
        flagred.evaluate([good, notes, tmp_path / "none.bin"])
    with pytest.raises(FileNotFoundError):
        flagred.evaluate([good, tmp_path / "none.bin", notes])
    some = flagred.evaluate([good, notes, tmp_path / "none.bin"], skip_bad_logs=True)
    assert [Path(file.file).name for file in some.left_out] == ["notes.txt", "none.bin"]
    assert some.estimators == flagred.evaluate(good).estimators
    bare = flagred.read_log(b"t_s,motor1,motor2,motor3,motor4,in_air\n0,0.4,0.4,0.5,0.5,1\n1,0.4,0.4,0.5,0.5,1\n")
    with pytest.raises(flagred.LogError, match="`<bytes>` cannot be evaluated: the attitude or its set point"):
        flagred.evaluate(bare)
    for nothing in ([], tmp_path, [bare]):
        with pytest.raises(flagred.LogError, match="no steps to evaluate"):
            flagred.evaluate(nothing, skip_bad_logs=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"horizon_s": 0}, "`horizon_s` is 0"),
        ({"horizon_s": float("nan")}, "`horizon_s` is NaN"),
        ({"threads": 0}, "at least 1"),
        ({"rows": {"att_rmse_deg": [1]}}, "logs and rows are given"),
        ({"profiles": "flagged"}, "No such file"),
    ],
)
def test_wrong_arguments(folder, options, message):
    with pytest.raises((flagred.DataError, FileNotFoundError), match=message):
        flagred.evaluate(folder, **options)


ROWS = """\
frame,c_limit_low,c_limit_high,margin_mean,margin_min_mean,c_mean,c_std,c_std_time,c_std_motors,sat_lim_frac,att_rmse_deg,crashed
a,0,1,0.4,0.39,0.6,0.011,0.01,0.003,0,0.2,0
a,0,1,0.35,0.3,0.65,0.075,0.02,0.07,0.02,3.1,0
b,0,1,0.2,0.1,0.8,0.16,0.04,0.12,0.1,6.2,0
b,0,1,0.1,0.02,0.9,0.2,0.05,0.14,0.2,4.0,1
"""


def columns() -> dict:
    names, *rows = (line.split(",") for line in ROWS.splitlines())
    return {name: list(map(str if name == "frame" else float, cells)) for name, cells in zip(names, zip(*rows))}


def test_whole_flights_are_evaluated_as_by_the_command_line(tmp_path):
    (tmp_path / "rows.csv").write_text(ROWS)
    found = flagred.evaluate(rows=columns())
    assert found.cases == "flights" and found.horizon_s is None and found.flights == []
    assert found.estimators["lowest_motor"].areas.auc == 1 and found.estimators["spread"].quiet is None
    assert found.scores.keys()[:2] == ["flight", "critical"] and found.scores["critical"].tolist() == [0, 0, 1, 1]
    assert any("has no column for its input `unsteady_now`" in note for note in found.notes)
    assert "4 flights of 2 vehicles" in found.html()
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    assert flagred.evaluate(rows=pandas.read_csv(tmp_path / "rows.csv")).to_json() == found.to_json()
    assert found.to_dict() == json.loads(command("--json", "--rows", tmp_path / "rows.csv"))


def test_rows_that_cannot_be_used():
    with pytest.raises(flagred.DataError, match="no column `att_rmse_deg`"):
        flagred.evaluate(rows={"c_mean": [0.5]})
    with pytest.raises(flagred.DataError, match="row 1, column `att_rmse_deg`: not a finite number"):
        flagred.evaluate(rows={**columns(), "att_rmse_deg": [1, None, 2, 3]})
    with pytest.raises(flagred.DataError, match="row 0, column `c_mean`: not a finite number"):
        flagred.evaluate(rows={**columns(), "c_mean": ["a", "b", "c", "d"]})
    with pytest.raises(flagred.DataError, match="different lengths"):
        flagred.evaluate(rows={**columns(), "c_mean": [1.0]})


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as POSIX does")
def test_an_interrupt_ends_an_evaluation(folder):
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        flagred.evaluate([folder / "deep/c.csv"] * 20_000)
    assert time.monotonic() - begun < 20
