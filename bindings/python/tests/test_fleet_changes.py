"""Changes of a fleet: firmware, parts and weeks of all vehicles, and vehicles with a step or a trend."""

import datetime
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("distributed", reason="Dask is not installed: `pip install flagred[fleet]`")
pytest.importorskip("duckdb", reason="DuckDB is not installed: `pip install flagred[fleet]`")

from conftest import ROOT
from flagred import fleet
from flagred.fleet.alerts import alerts, sentence
from flagred.fleet.history import histories

sys.path.insert(0, str(ROOT / "benches/fleet"))
import planted
import synthetic

VEHICLES, FLIGHTS = 8, 40
Rise = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def rows(seed: int, rise: Rise, firmware: Rise | None = None, windy_since: float = 100.0) -> dict[str, np.ndarray]:
    """Flights on 40 days of 8 vehicles. The risk rises by 1 % with each m/s of wind, and by `rise`, which depends on
    vehicle, week and wind."""
    chance = np.random.default_rng(seed)
    vehicle = np.repeat(np.arange(VEHICLES), FLIGHTS)
    day = np.concatenate([np.sort(chance.choice(140, FLIGHTS, replace=False)) for _ in range(VEHICLES)])
    week = day / 7
    wind = chance.gamma(4, 1, len(day)) + np.where(week >= windy_since, 5, 0)
    mean = np.clip(20 + vehicle + wind + chance.normal(0, 3, len(day)) + rise(vehicle, week, wind), 0, 100)
    return {
        "vehicle": np.char.add("v", vehicle.astype(str)),
        "firmware": np.where(firmware(vehicle, week, wind), "B", "A") if firmware else np.full(len(day), "A"),
        "start_s": synthetic.START_S + day * 86_400.0 + 36_000,
        "in_air_s": chance.uniform(200, 900, len(day)),
        "wind_m_s": wind,
        "risk_mean_pct": mean,
        "risk_max_pct": np.clip(mean + chance.gamma(2, 10, len(day)), 0, 100),
        "verdict": np.full(len(day), "GOOD"),
    }


def changes(tmp_path: Path, columns: dict[str, np.ndarray], parts: dict | None = None) -> list[fleet.Change]:
    synthetic.write_rows(tmp_path / "out", columns)
    return fleet.find_changes(fleet.open_dataset(str(tmp_path / "out")), parts)


def steady(vehicle, week, wind):
    return np.zeros(len(week))


def week_of(change: fleet.Change) -> float:
    return (change.since_s - synthetic.START_S) / synthetic.WEEK_S


def test_a_firmware_is_found_in_its_vehicles_and_reported_once(tmp_path):
    has_new = lambda vehicle, week, wind: (vehicle < 4) & (week >= 8 + vehicle)
    (change,) = changes(tmp_path, rows(1, lambda *of: np.where(has_new(*of), 4, 0), has_new))
    assert (change.kind, change.cause, change.is_fleet, change.vehicles) == ("step", "firmware B", True, ("v0", "v1", "v2", "v3"))
    assert change.low_pct < 4 < change.high_pct and change.low_pct > 2
    assert change.others[1] < 0 < change.others[2]
    assert change.p <= 0.01 and sum(change.flights) == 4 * FLIGHTS
    text = sentence(change)
    assert text.startswith("With firmware B the mean risk of 4 vehicles rose by ") and "Vehicles without it changed by" in text


def test_a_stronger_wind_is_not_a_change(tmp_path):
    has_new = lambda vehicle, week, wind: week >= 10
    assert changes(tmp_path, rows(2, steady, has_new, windy_since=10)) == []
    # If the wind is not in the dataset, the same flights differ by the effect of 5 m/s of wind: 5 %.
    blind = rows(2, steady, has_new, windy_since=10)
    blind["wind_m_s"] = np.zeros(len(blind["wind_m_s"]))
    (change,) = changes(tmp_path / "blind", blind)
    assert change.low_pct < 5 < change.high_pct


def test_a_jump_is_not_called_growing_riskier_and_wear_is_not_called_a_jump(tmp_path):
    rise = lambda vehicle, week, wind: np.where((vehicle == 2) & (week >= 9), 14, 0) + np.where(vehicle == 5, 0.8 * week, 0)
    worn, jumped = sorted(changes(tmp_path, rows(3, rise)), key=lambda change: change.kind)
    assert (worn.vehicles, worn.kind, worn.is_fleet) == (("v5",), "slope", False)
    assert worn.slope_pct_week == pytest.approx(0.8, abs=0.2) and worn.change_pct == pytest.approx(16, abs=4)
    assert "v5 grows riskier" in sentence(worn)
    assert (jumped.vehicles, jumped.kind, jumped.cause) == (("v2",), "step", None)
    assert week_of(jumped) == pytest.approx(9, abs=1)
    assert "v2 changed once" in sentence(jumped) and "riskier" not in sentence(jumped)
    assert worn.is_clear and jumped.is_clear
    assert "v5 grows riskier, gradually or at once: " in sentence(replace(worn, is_clear=False))
    assert "the flights do not show which" in sentence(replace(jumped, is_clear=False))


def test_wear_of_one_vehicle_is_not_blamed_on_a_firmware_of_all(tmp_path):
    worn = lambda vehicle, week, wind: np.where(vehicle == 5, 1.2 * week, 0)
    (change,) = changes(tmp_path, rows(4, worn, lambda vehicle, week, wind: week >= 10))
    assert (change.vehicles, change.kind) == (("v5",), "slope")


def test_wear_of_the_only_vehicle_with_a_firmware_is_not_blamed_on_it(tmp_path):
    worn = lambda vehicle, week, wind: np.where(vehicle == 5, week, 0)
    (change,) = changes(tmp_path, rows(4, worn, lambda vehicle, week, wind: (vehicle == 5) & (week >= 10)))
    assert (change.vehicles, change.kind, change.cause) == (("v5",), "slope", None)


def test_a_part_is_a_cause(tmp_path):
    since_s = synthetic.START_S + 9 * synthetic.WEEK_S
    parts = {"v2": [(since_s, "new propellers")]}
    (change,) = changes(tmp_path, rows(5, lambda vehicle, week, wind: np.where((vehicle == 2) & (week >= 9), -8, 0)), parts)
    assert (change.cause, change.vehicles) == ("new propellers", ("v2",))
    assert "v2 changed once, on " in sentence(change) and " with new propellers: its " in sentence(change)
    assert change.high_pct < 0 and alerts([change], 0.0) == []


def test_a_week_in_which_all_change_is_named_once(tmp_path):
    (change,) = changes(tmp_path, rows(6, lambda vehicle, week, wind: np.where(week >= 12, 4, 0)))
    assert change.is_fleet and change.cause is None and len(change.vehicles) == VEHICLES
    assert week_of(change) == pytest.approx(12, abs=1)
    assert sentence(change).startswith("In the week of ")


def test_a_calm_fleet_and_small_ones_have_no_changes(tmp_path):
    assert changes(tmp_path / "calm", rows(7, steady)) == []
    few = {name: of[:5] for name, of in rows(8, steady).items()}
    assert changes(tmp_path / "few", few) == []
    equal = rows(9, steady)
    equal["risk_mean_pct"] = equal["risk_max_pct"] = np.full(len(equal["vehicle"]), 20.0)
    assert changes(tmp_path / "equal", equal) == []


def test_flights_of_a_day_are_one_row_and_counts_are_those_that_warned(tmp_path):
    columns = {name: np.repeat(of, 3) for name, of in rows(10, steady).items()}
    columns["start_s"] = columns["start_s"] + np.tile([0, 600, 1200], len(columns["start_s"]) // 3)
    columns["verdict"] = np.tile(["WARN", "GOOD", "GOOD"], len(columns["start_s"]) // 3)
    synthetic.write_rows(tmp_path / "out", columns)
    found, is_adjusted = histories(fleet.open_dataset(str(tmp_path / "out")))
    assert is_adjusted and [len(history) for history in found] == [FLIGHTS] * VEHICLES
    assert all((history.flights == 3).all() and (history.warned == 1).all() for history in found)


def test_a_slope_is_the_regression_of_scipy(tmp_path):
    stats = pytest.importorskip("scipy.stats", reason="scipy is not installed")
    columns = {name: of[:FLIGHTS] for name, of in rows(11, lambda vehicle, week, wind: 2 * week).items()}
    # 39 pairs of flights are too few to estimate the influence of the wind.
    (change,) = changes(tmp_path, columns)
    line = stats.linregress(columns["start_s"] / synthetic.WEEK_S, columns[change.measure])
    weeks = np.ptp(columns["start_s"]) / synthetic.WEEK_S
    half = line.stderr * stats.t.ppf(0.975, FLIGHTS - 2)
    assert change.slope_pct_week == pytest.approx(line.slope)
    assert change.low_pct == pytest.approx((line.slope - half) * weeks, rel=1e-3)
    assert change.high_pct == pytest.approx((line.slope + half) * weeks, rel=1e-3)


def test_the_same_dataset_gives_the_same_answer(tmp_path):
    columns = rows(12, lambda vehicle, week, wind: np.where((vehicle == 2) & (week >= 9), 8, 0))
    synthetic.write_rows(tmp_path / "out", columns)
    first, second = (fleet.find_changes(fleet.open_dataset(str(tmp_path / "out"))) for _ in range(2))
    assert first == second and first
    assert datetime.datetime.fromtimestamp(first[0].since_s, datetime.timezone.utc).year == 2026


def test_planted_changes_are_found_and_a_calm_fleet_is_calm():
    """A few of the fleets of benches/fleet/planted.py, which prints the figures."""
    for seed in (0, 1):
        firmware, worn, jumped = planted.changes(seed, True)
        assert firmware.cause == "firmware ArduCopter V4.6.1" and len(firmware.vehicles) == 6
        assert (worn.vehicles, worn.kind) == (("v5",), "slope")
        assert (jumped.vehicles, jumped.kind) == (("v9",), "step")
        assert planted.changes(10_000 + 2 + seed, False) == []
