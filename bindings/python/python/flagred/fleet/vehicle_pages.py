"""A page for each vehicle: its risk over time, its changes, its motors, and the flights that warned."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np

from .._core import _page
from .alerts import advice, sentence
from .changes import MIN_DAYS, LEVEL, Change
from .charts import Mark, Point, chart
from .permutation import student
from .tables import STYLE, Column, Row, date, day, figures, known, link, log_link, number, table, verdict

__all__ = ["write_vehicle_pages"]

MAX_FLIGHTS = 400
"""The number of latest flights on the page of a vehicle."""
MIN_FLIGHTS = 8
"""The minimum number of flights to estimate a drift."""
WEEK_S = 604_800

QUERY = f"""
SELECT f.*, w.what, w.advice FROM (
  SELECT flight_id, vehicle, vehicle_id, site, pilot, log, epoch(start_utc) AS start_s, start_utc, firmware, verdict, in_air_s,
    risk_mean_pct, risk_max_pct, motor_commands, motor_margins, weakest_motor, weakest_margin
  FROM judged WHERE vehicle IN (SELECT unnest(?)) AND risk_max_pct IS NOT NULL
  QUALIFY row_number() OVER (PARTITION BY vehicle ORDER BY start_utc DESC NULLS LAST, flight_id) <= {MAX_FLIGHTS}) f
LEFT JOIN (
  SELECT flight_id, arg_max(text, (severity = 'FAIL')::INT * 1000 + coalesce(value_pct, 0)) AS what,
    arg_max(advice, (severity = 'FAIL')::INT * 1000 + coalesce(value_pct, 0)) AS advice
  FROM findings WHERE severity IN ('WARN', 'FAIL') GROUP BY flight_id) w USING (flight_id)
ORDER BY vehicle, start_utc, flight_id
"""


def write_vehicle_pages(
    files: Path,
    connection: Any,
    vehicles: Sequence[str],
    changes: Sequence[Change],
    parts: Mapping[str, Sequence[tuple[float, str]]],
    reports: Mapping[str, str],
    back: str,
) -> dict[str, str]:
    """Writes the page of each vehicle into ``vehicles``. Returns the files by vehicle."""
    flights: dict[str, list[Row]] = {}
    for batch in connection.sql(QUERY, params=[list(vehicles)]).to_arrow_table().to_batches(20_000):
        for row in batch.to_pylist():
            flights.setdefault(row["vehicle"], []).append(row)
    folder = files / "vehicles"
    folder.mkdir(parents=True, exist_ok=True)
    written = {vehicle: f"vehicles/{_file(vehicle)}" for vehicle in flights}
    for vehicle, rows in flights.items():
        of = [change for change in changes if vehicle in change.vehicles]
        body = _body(vehicle, rows, len(flights), of, parts.get(vehicle, ()), {id: f"../{file}" for id, file in reports.items()}, f"../../{back}")
        path = files / written[vehicle]
        unfinished = path.with_name(f".{path.name}.unfinished")
        unfinished.write_text(_page(vehicle, body), encoding="utf-8")
        os.replace(unfinished, path)
    for path in folder.glob("*.html"):
        if f"vehicles/{path.name}" not in written.values():
            path.unlink()
    return written


def _file(vehicle: str) -> str:
    """The name of the vehicle in letters that any file system accepts; a hash distinguishes similar names."""
    return f"{re.sub('[^A-Za-z0-9_-]+', '-', vehicle)[:40]}-{hashlib.sha256(vehicle.encode()).hexdigest()[:8]}.html"


def _body(
    vehicle: str, rows: Sequence[Row], vehicles: int, changes: Sequence[Change], parts: Sequence[tuple[float, str]], reports: Mapping[str, str], back: str
) -> str:
    last = rows[-1]
    warned = [row for row in rows if row["verdict"] in ("WARN", "FAIL")]
    about = [f"{title} {last[name]}" for title, name in (("site", "site"), ("pilot", "pilot"), ("identified as", "vehicle_id")) if last[name] and last[name] != vehicle]
    shown = {
        "flights": f"{len(rows):,}",
        "flights that warned": f"{len(warned):,}",
        "in the air": f"{sum(row['in_air_s'] or 0 for row in rows) / 3600:.1f} h",
        "firmware": escape(last["firmware"] or "NA"),
        "last flight": date(last["start_utc"]),
    }
    acts = "".join(
        f"<li class={'fail' if change.change_pct > 0 else 'good'}>{escape(sentence(change))}<span class=advice>{escape(advice(change))}</span></li>"
        for change in changes
    )
    return "\n".join(
        [
            STYLE,
            f"<p class=soft>{link('Back to the fleet', back)}</p><h1>{escape(vehicle)}</h1><p class=soft>{escape(', '.join(about))}</p>",
            figures(shown),
            f"<ul class=act>{acts}</ul>" if acts else f"<p>{_calm(rows)}</p>",
            _over_time(rows, parts),
            "<h2>Motors</h2>",
            _motors(rows, vehicles),
            f"<h2>Flights that warned</h2>{_warned(warned[::-1], reports)}",
            f"<p class=soft>The latest {MAX_FLIGHTS} judged flights are shown.</p>" if len(rows) == MAX_FLIGHTS else "",
        ]
    )


def _calm(rows: Sequence[Row]) -> str:
    days = {date(row["start_utc"]) for row in rows if row["start_utc"] is not None}
    if len(days) < MIN_DAYS:
        return f"Whether the risk of this vehicle changes is unknown: it has flights on fewer than {MIN_DAYS} days."
    return "The risk of this vehicle did not change more than by chance."


def _over_time(rows: Sequence[Row], parts: Sequence[tuple[float, str]]) -> str:
    dated = [row for row in rows if row["start_s"] is not None]
    if not dated:
        return "<p class=soft>No log reports its date, so the risk over time cannot be drawn.</p>"
    marks = [Mark(at_s, part) for at_s, part in parts if dated[0]["start_s"] <= at_s <= dated[-1]["start_s"]]
    firmware = None
    for row in dated:
        if row["firmware"] and firmware not in (None, row["firmware"]):
            marks.append(Mark(row["start_s"], row["firmware"]))
        firmware = row["firmware"] or firmware
    risks, margins = [], []
    for row in dated:
        words = f"{date(row['start_utc'])}: {row['verdict']}, highest risk {row['risk_max_pct']:.0f} %, mean {known(row['risk_mean_pct'], 0)} %"
        mean = row["risk_mean_pct"] if row["risk_mean_pct"] is not None else row["risk_max_pct"]
        risks.append(Point(row["start_s"], row["risk_max_pct"], mean, row["risk_max_pct"], row["verdict"].lower(), words))
        if row["weakest_margin"] is not None:
            margin = 100 * row["weakest_margin"]
            words = f"{date(row['start_utc'])}: motor {row['weakest_motor']}, mean margin {margin:.0f} %"
            margins.append(Point(row["start_s"], margin, margin, margin, "motor", words))
    return (
        "<h2>Risk of each flight</h2>"
        + chart("Highest risk of each flight (colour: verdict), with a line down to its mean risk, %", risks, marks)
        + chart("Margin of the weakest motor of each flight, % of its range", margins, marks, large=False)
    )


def _motors(rows: Sequence[Row], vehicles: int) -> str:
    """The table of the motors. A motor is named first if a drift like its own occurs by chance with a probability of at most
    ``LEVEL`` among all motors of this many vehicles."""
    counts = [len(row["motor_margins"] or ()) for row in rows]
    motors = max(counts)
    of = [row for row, count in zip(rows, counts) if count == motors]
    if motors == 0:
        return "<p class=soft>No flight has known commands of all motors.</p>"
    margins = np.array([row["motor_margins"] for row in of])
    commands = 100 * np.array([row["motor_commands"] for row in of])
    times = np.array([np.nan if row["start_s"] is None else row["start_s"] / WEEK_S for row in of])
    least = margins.argmin(axis=1)
    found: list[Row] = []
    for motor in range(motors):
        others = np.delete(commands, motor, axis=1).mean(axis=1) if motors > 1 else np.zeros(len(of))
        drift = _slope(times, commands[:, motor] - others)
        found.append({"motor": motor + 1, "least": int((least == motor).sum()), "margin": 100 * margins[:, motor].mean(), "drift": drift})
    columns: Sequence[Column] = (
        number("Motor", "motor"),
        number("Flights in which it had the least margin", "least"),
        number("Mean margin, %", "margin", 1),
        ("Command relative to the other motors, % per week", "n", lambda row: "NA" if row["drift"] is None else f"{known(row['drift'][0], 2)}<small>{known(row['drift'][1], 2)} to {known(row['drift'][2], 2)}</small>"),
    )
    note = "<p class=soft>A motor whose command rises relative to the others gives less thrust than before: check propeller, motor and speed controller.</p>"
    surely = NormalDist().inv_cdf(1 - LEVEL / (motors * vehicles)) / NormalDist().inv_cdf(0.975)
    worst = max(found, key=lambda row: row["drift"][0] if row["drift"] else -np.inf)
    if worst["drift"] is None or worst["drift"][0] - surely * (worst["drift"][0] - worst["drift"][1]) <= 0:
        return table(found, columns, "") + note
    slope, low, high = worst["drift"]
    rises = f"The command of motor {worst['motor']} rises by {slope:.2f} % of its range per week, relative to the others ({low:.2f} to {high:.2f}). Check it first."
    return f"<ul class=findings><li class=warn>{rises}</li></ul>" + table(found, columns, "") + note


def _slope(x: Any, y: Any) -> tuple[float, float, float] | None:
    """The slope with its 95 % interval; None for too few flights."""
    is_known = np.isfinite(x)
    x, y = x[is_known] - x[is_known].mean() if is_known.any() else x[is_known], y[is_known]
    if len(x) < MIN_FLIGHTS or not (x**2).sum() > 0:
        return None
    slope = float((x * y).sum() / (x**2).sum())
    left = float(((y - y.mean() - slope * x) ** 2).sum())
    half = student(len(x) - 2) * float(np.sqrt(left / (len(x) - 2) / (x**2).sum()))
    return slope, slope - half, slope + half


def _warned(rows: Sequence[Row], reports: Mapping[str, str]) -> str:
    def words(row: Row) -> str:
        what = escape(row["what"] or "")
        advice = f"<small>{escape(row['advice'])}</small>" if row["advice"] else ""
        to = link(f"report of {Path(row['log']).name}", reports[row["flight_id"]]) if row["flight_id"] in reports else log_link(row["log"])
        return f"{what}{advice}<small>{to}</small>"

    columns: Sequence[Column] = (
        verdict("Verdict", "verdict"),
        day("Day", "start_utc"),
        number("Highest risk, %", "risk_max_pct", 0),
        ("What happened", "words", words),
    )
    return table(rows, columns, "No flight warned.")
