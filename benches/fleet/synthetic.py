"""Datasets of generated flights at random times, of any size, with vehicles whose risk rises by a known amount."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from flagred import fleet

WEEK_S = 604_800
START_S = 1_767_571_200  # Monday, 5 January 2026.
CAUSES = [
    ("fighting_gusts", "Over 20 s the motors changed strongly to hold attitude, as in gusts. A stronger gust may be too much.", "Reduce speed and height, or land."),
    ("thrust_surges", "The thrust of all motors together rose and fell strongly, as in turbulence or fast climbs and descents.", "Climb and descend more slowly."),
    ("motor_at_limit", "Over 2 s, 12 % of the motor commands were at a limit, where a motor cannot correct anything.", "Land now and gently."),
]


def write(out: Path, flights: int, vehicles: int, weeks: int = 26, rising: dict[str, float] | None = None, seed: int = 1) -> None:
    """Writes this many flights. The risk of the vehicles in `rising` grows by this many percent per week."""
    chance = np.random.default_rng(seed)
    slopes = np.zeros(vehicles)
    for name, slope in (rising or {}).items():
        slopes[int(name.removeprefix("v"))] = slope
    for part, begin in enumerate(range(0, flights, 250_000)):
        count = min(250_000, flights - begin)
        vehicle = chance.integers(0, vehicles, count)
        start_s = START_S + chance.uniform(0, weeks * WEEK_S, count)
        mean = np.clip(20 + vehicle % 7 + slopes[vehicle] * (start_s - START_S) / WEEK_S + chance.normal(0, 4, count), 0, 100)
        highest = np.clip(mean * chance.uniform(1.2, 3.5, count), 0, 100)
        verdict = np.where(highest > 90, "FAIL", np.where(highest > 67, "WARN", "GOOD")).astype(object)
        verdict[chance.random(count) < 0.02] = "NA"
        lost = chance.random(count) < 0.003
        ids = [f"{begin + i:020x}" for i in range(count)]
        names = [f"v{number:05}" for number in vehicle]
        columns = {
            "log": [f"/logs/vehicle={name}/{id}.BIN" for name, id in zip(names, ids)],
            "bytes": np.full(count, 4_400_000),
            "identity": np.full(count, "4400000-0"),
            "deleted": np.zeros(count, bool),
            "flight_id": ids,
            "status": np.where(lost, "unreadable", "assessed"),
            "error": _known(np.where(chance.random(count) < 0.5, "is empty", "is a PDF document, not a flight log"), lost),
            "vehicle": names,
            "firmware": _known(np.char.add("ArduCopter V4.", (5 + (start_s > START_S + weeks * WEEK_S / 2)).astype(str)), ~lost),
            "start_utc": _known((start_s * 1e6).astype("int64"), ~lost),
            "in_air_s": _known(chance.uniform(60, 900, count), ~lost),
            "assessed_s": _known(chance.uniform(50, 900, count), ~lost),
            "filled_s": _known(np.zeros(count), ~lost),
            "wind_m_s": _known(chance.gamma(2, 2, count), ~lost),
            "verdict": _known(verdict, ~lost),
            "reason": _known(np.full(count, "the vehicle was never in the air"), ~lost & (verdict == "NA")),
            "risk_mean_pct": _known(mean, ~lost & (verdict != "NA")),
            "risk_max_pct": _known(highest, ~lost & (verdict != "NA")),
            "elevated_risk_max_pct": _known(np.clip(highest - 60, 0, 100), ~lost & (verdict != "NA")),
            "saturated_share": _known(chance.beta(1, 50, count), ~lost),
            "profile": np.full(count, "flagred"),
            "settings": np.full(count, "made up"),
            "flagred": np.full(count, "0.0.0"),
        }
        table = pa.table([_column(columns.get(f.name), f, count) for f in fleet.FLIGHTS], fleet.FLIGHTS)
        month = (start_s * 1e6).astype("int64").astype("datetime64[us]").astype("datetime64[M]").astype(str)
        month[lost] = fleet.schema.MONTH_UNKNOWN
        _by_month(out / "flights", table, month, part)
        warned = np.flatnonzero(~lost & ((verdict == "WARN") | (verdict == "FAIL")))
        findings = _findings(table.take(warned), chance)
        _by_month(out / "findings", findings, month[warned], part)


def write_rows(out: Path, columns: dict[str, np.ndarray]) -> None:
    """Writes a dataset of assessed flights with these columns and ``start_s``; the other columns are generated."""
    count = len(columns["start_s"])
    ids = [f"{i:020x}" for i in range(count)]
    made_up = {
        "log": [f"/logs/vehicle={name}/{id}.BIN" for name, id in zip(columns["vehicle"], ids)],
        "bytes": np.full(count, 4_400_000),
        "identity": np.full(count, "4400000-0"),
        "deleted": np.zeros(count, bool),
        "flight_id": ids,
        "status": np.full(count, "assessed"),
        "start_utc": (columns["start_s"] * 1e6).astype("int64"),
        "assessed_s": columns["in_air_s"],
        "findings": (columns["verdict"] != "GOOD").astype(int),
        "profile": np.full(count, "flagred"),
        "settings": np.full(count, "made up"),
        "flagred": np.full(count, "0.0.0"),
    }
    flights = pa.table([_column((made_up | columns).get(f.name), f, count) for f in fleet.FLIGHTS], fleet.FLIGHTS)
    months = made_up["start_utc"].astype("datetime64[us]").astype("datetime64[M]").astype(str)
    _by_month(out / "flights", flights, months, 0)
    warned = np.flatnonzero(columns["verdict"] != "GOOD")
    _by_month(out / "findings", _findings(flights.take(warned), np.random.default_rng(1)), months[warned], 0)


def _known(values: np.ndarray, known: np.ndarray) -> pa.Array:
    return pa.array(values, mask=~known)


def _column(values: object, field: pa.Field, count: int) -> pa.Array:
    if values is None:
        return pa.nulls(count, field.type)
    return pa.array(values).cast(field.type)


def _findings(flights: pa.Table, chance: np.random.Generator) -> pa.Table:
    count = len(flights)
    begin = chance.uniform(0, 100, count)
    cause = chance.choice(3, count, p=[0.6, 0.25, 0.15])
    peak = flights["risk_max_pct"].to_pylist()
    columns = {
        "flight_id": flights["flight_id"].combine_chunks(),
        "vehicle": flights["vehicle"].combine_chunks(),
        "severity": flights["verdict"].combine_chunks(),
        "measure": np.full(count, "risk"),
        "from_s": begin,
        "raised_s": begin + 1,
        "to_s": begin + chance.gamma(2, 10, count),
        "value_pct": flights["risk_max_pct"].combine_chunks(),
        "motor": chance.integers(1, 5, count),
        "side": np.where(chance.random(count) < 0.8, "upper", "lower"),
        "margin_mean": chance.uniform(0, 0.2, count),
        "rule": np.full(count, "IF margin IS low THEN risk IS high"),
        "code": [CAUSES[i][0] for i in cause],
        "text": [f"{CAUSES[i][1]} The risk reached {value:.0f} %." for i, value in zip(cause, peak)],
        "advice": [CAUSES[i][2] for i in cause],
    }
    return pa.table([_column(columns.get(f.name), f, count) for f in fleet.FINDINGS], fleet.FINDINGS)


def _by_month(folder: Path, table: pa.Table, months: np.ndarray, part: int) -> None:
    for month in np.unique(months):
        of = folder / f"month={month}"
        of.mkdir(parents=True, exist_ok=True)
        pq.write_table(table.filter(pa.array(months == month)), of / f"{part}.parquet", compression="zstd")
