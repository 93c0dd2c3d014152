"""New flights, vehicles and alerts since the last report."""

from __future__ import annotations

import datetime
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from .questions import ask

__all__ = ["News", "known_before", "remember"]

SEEN, LAST = "seen.parquet", "last.json"


@dataclass(frozen=True)
class News:
    """The differences from the last report. In a first report, nothing is new."""

    last_utc: str | None
    """The time of the last report; None if there is none, or its files are damaged."""
    flights: int
    warned: int
    vehicles: list[str]
    worst: list[dict[str, Any]]
    """The new flights among the worst ones that warned."""
    alerts: frozenset[str]
    """The alerts of the last report."""

    def is_new(self, alert: str) -> bool:
        return alert not in self.alerts


def known_before(files: Path, connection: Any, alerts: Sequence[str]) -> News:
    """Compares a dataset with the data of the last report in the same folder."""
    try:
        last = json.loads((files / LAST).read_text(encoding="utf-8"))
        seen = pq.read_table(files / SEEN)
        last_utc, before = str(last["written_utc"]), frozenset(map(str, last["alerts"]))
    except (OSError, ValueError, KeyError, TypeError, pa.ArrowException):
        return News(None, 0, 0, [], [], frozenset())
    connection.register("seen", seen)
    new = "FROM flights WHERE status = 'assessed' AND flight_id NOT IN (SELECT flight_id FROM seen)"
    flights, warned = connection.execute(f"SELECT count(*), count(*) FILTER (WHERE verdict IN ('WARN', 'FAIL')) {new}").fetchone()
    vehicles = connection.execute(
        f"SELECT DISTINCT vehicle {new} AND vehicle IS NOT NULL AND vehicle NOT IN (SELECT vehicle FROM seen WHERE vehicle IS NOT NULL) ORDER BY 1"
    ).fetchall()
    ids = {id for (id,) in connection.execute(f"SELECT flight_id {new} AND verdict IN ('WARN', 'FAIL')").fetchall()}
    worst = [row for row in ask(connection, "worst").to_pylist() if row["flight_id"] in ids]
    return News(last_utc, flights, warned, [vehicle for (vehicle,) in vehicles], worst, before)


def remember(files: Path, connection: Any, alerts: Sequence[str]) -> None:
    """Saves the data of a report for the next one."""
    files.mkdir(parents=True, exist_ok=True)
    seen = connection.sql("SELECT flight_id, vehicle FROM flights WHERE status = 'assessed'").to_arrow_table()
    unfinished = files / f".{SEEN}.unfinished"
    pq.write_table(seen, unfinished, compression="zstd")
    os.replace(unfinished, files / SEEN)
    now = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
    (files / LAST).write_text(json.dumps({"written_utc": now, "alerts": list(alerts)}), encoding="utf-8")
