"""Measures whether planted changes are found, and how often a calm fleet raises a false alert: python benches/fleet/planted.py

The rows are generated: 12 vehicles fly 48 times in 24 weeks, on 24 to 48 different days. The risk depends on the wind,
which is stronger in the second half, on the time in the air and on the day. There are two kinds of fleets:

- planted: half of the vehicles have flown 20 times each with a firmware that raises the share of flights that warn from 5
% to 25 %.   Of the others, one wears out, by 0.76 % of mean risk per week, and the risk of another jumps once, by 10 %.
- calm: the same weather and firmware, without any effect.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import synthetic

from flagred import fleet

VEHICLES, FLIGHTS, WEEKS = 12, 48, 24
WITH_FIRMWARE = range(0, VEHICLES, 2)
WORN, SLOPE_PCT_WEEK = 5, 0.76
JUMPED, JUMP_PCT, JUMP_WEEK = 9, 10, 10
WARNED_BEFORE, WARNED_AFTER = 0.05, 0.25
AFTER = 20
"""The number of flights of a vehicle with the new firmware."""


def chance_to_warn(share: float, wind: np.ndarray) -> np.ndarray:
    """The probability that each flight warns. It rises with the wind; over typical winds (4 m/s on average), its mean is
    `share`."""
    typical = np.random.default_rng(0).gamma(4, 1, 20_000)
    low, high = -20.0, 20.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if (1 / (1 + np.exp(-middle - 0.3 * typical))).mean() < share else (low, middle)
    return 1 / (1 + np.exp(-low - 0.3 * wind))


def write(out: Path, seed: int, is_planted: bool) -> None:
    """Writes the dataset of one fleet."""
    chance = np.random.default_rng(seed)
    vehicle = np.repeat(np.arange(VEHICLES), FLIGHTS)
    days = np.sort(chance.integers(0, 7 * WEEKS, (VEHICLES, FLIGHTS)), axis=1)
    hour = np.sort(chance.uniform(8, 18, (VEHICLES, FLIGHTS)), axis=1)
    start_s = (synthetic.START_S + days * 86_400 + hour * 3600).ravel()
    week = days.ravel() / 7
    has_new = np.isin(vehicle, WITH_FIRMWARE) & (np.tile(np.arange(FLIGHTS), VEHICLES) >= FLIGHTS - AFTER)
    # Flights of one day have the same weather and task.
    key = vehicle * 1000 + days.ravel()
    _, of_day = np.unique(key, return_inverse=True)
    wind = np.maximum(chance.gamma(4, 1, of_day.max() + 1)[of_day] * np.where(week > WEEKS / 2, 1.25, 1) + chance.normal(0, 0.5, len(key)), 0)
    share = chance_to_warn(WARNED_BEFORE, wind)
    if is_planted:
        share = np.where(has_new, chance_to_warn(WARNED_AFTER, wind), share)
    is_warned = chance.random(len(key)) < share
    in_air_s = chance.uniform(120, 1200, len(key))
    day_effect = chance.normal(0, 2, of_day.max() + 1)[of_day]
    mean = 14 + vehicle % 5 + 1.2 * wind + 2 * np.log(in_air_s / 600) + day_effect + chance.normal(0, 3, len(key)) + 6 * is_warned
    if is_planted:
        mean = mean + np.where(vehicle == WORN, SLOPE_PCT_WEEK * week, 0) + np.where((vehicle == JUMPED) & (week >= JUMP_WEEK), JUMP_PCT, 0)
    mean = np.clip(mean, 1, 95)
    # Motor 3 of the worn vehicle loses thrust from week to week.
    commands = 0.45 + 0.004 * wind[:, None] + chance.normal(0, 0.01, (len(key), 4))
    if is_planted:
        commands[:, 2] += np.where(vehicle == WORN, 0.004 * week, 0)
    margins = np.minimum(commands, 1 - commands) - 0.1
    highest = np.where(is_warned, chance.uniform(67, 98, len(key)), np.minimum(mean * chance.uniform(1.2, 2.5, len(key)), 66.9))
    synthetic.write_rows(
        out,
        {
            "vehicle": np.char.add("v", vehicle.astype(str)),
            "firmware": np.where(has_new, "ArduCopter V4.6.1", "ArduCopter V4.5.7"),
            "start_s": start_s,
            "in_air_s": in_air_s,
            "wind_m_s": wind,
            "risk_mean_pct": mean,
            "risk_max_pct": highest,
            "motor_commands": commands.tolist(),
            "motor_margins": margins.tolist(),
            "weakest_motor": margins.argmin(axis=1) + 1,
            "weakest_margin": margins.min(axis=1),
            "verdict": np.where(highest > 90, "FAIL", np.where(highest > 67, "WARN", "GOOD")),
        },
    )


def changes(seed: int, is_planted: bool) -> list[fleet.Change]:
    folder = Path(tempfile.mkdtemp(prefix="flagred-planted-"))
    try:
        write(folder / "out", seed, is_planted)
        return fleet.find_changes(fleet.open_dataset(str(folder / "out")))
    finally:
        shutil.rmtree(folder)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--planted", type=int, default=10, help="fleets with planted changes (10)")
    parser.add_argument("--calm", type=int, default=20, help="calm fleets (20)")
    given = parser.parse_args()
    begin_s = time.perf_counter()
    found_firmware = found_worn = found_jump = grows = wrong = false = 0
    for seed in range(given.planted):
        found = changes(seed, True)
        firmware = [change for change in found if change.cause == "firmware ArduCopter V4.6.1" and change.change_pct > 0]
        of_vehicles = [change for change in found if not change.is_fleet and change.change_pct > 0]
        found_firmware += bool(firmware)
        found_worn += bool(of_vehicles) and of_vehicles[0].vehicles == (f"v{WORN}",) and of_vehicles[0].kind == "slope"
        of_jumped = [change.kind for change in of_vehicles if change.vehicles == (f"v{JUMPED}",)]
        found_jump += of_jumped == ["step"]
        grows += "slope" in of_jumped
        wrong += sum(change not in firmware and change.vehicles not in ((f"v{WORN}",), (f"v{JUMPED}",)) for change in found)
    for seed in range(given.calm):
        false += any(change.low_pct > 0 for change in changes(10_000 + seed, False))
    print(f"firmware found within {AFTER} flights a vehicle: {found_firmware} of {given.planted} fleets")
    print(f"worn vehicle named first, as one that grows riskier: {found_worn} of {given.planted} fleets")
    print(f"jump of a vehicle found as a jump: {found_jump} of {given.planted} fleets, called growing riskier: {grows}")
    print(f"other changes named in these fleets: {wrong}")
    print(f"calm fleets with a false alert: {false} of {given.calm}")
    print(f"{(time.perf_counter() - begin_s) / max(1, given.planted + given.calm):.2f} s a fleet")
    is_met = found_firmware >= 0.9 * given.planted and found_worn >= 0.9 * given.planted and false <= max(1, given.calm / 20)
    return 0 if is_met else 1


if __name__ == "__main__":
    sys.exit(main())
