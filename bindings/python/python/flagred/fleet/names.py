"""Names, sites and pilots of vehicles, and changed parts, from CSV files."""

from __future__ import annotations

import csv
import datetime
import os
from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import Any

import pyarrow as pa

from .errors import FleetError

__all__ = ["EMPTY", "read_names", "read_parts", "view"]

KEYS = ("vehicle", "serial", "id", "vehicle_id")
"""Headings of the column that identifies a vehicle: by its name in the dataset, or by its ``vehicle_id``."""
COLUMNS = ("name", "site", "pilot")
EMPTY = pa.schema([(name, pa.string()) for name in ("vehicle", *COLUMNS)]).empty_table()


def read_names(path: str | os.PathLike[str]) -> pa.Table:
    """The names in a CSV file: a column `vehicle` (or `serial`, `id`), and optionally `name`, `site`, `pilot`.

    Raises
    ------
    FleetError
        The file has no column that identifies vehicles, names a vehicle twice, or gives two vehicles the same name.
    """
    rows: dict[str, dict[str, str | None]] = {}
    owners: dict[str, str] = {}
    for line, row in _rows(path, ()):
        key, name = row["vehicle"], row.get("name") or row["vehicle"]
        if key in rows:
            raise FleetError(f"{_at(path, line)}: vehicle `{key}` is listed twice", "keep one of the lines")
        if name in owners:
            raise FleetError(f"{_at(path, line)}: vehicles `{owners[name]}` and `{key}` have the same name `{name}`", "give each a different name")
        rows[key] = {"vehicle": key, "name": name, "site": row.get("site") or None, "pilot": row.get("pilot") or None}
        owners[name] = key
    return pa.Table.from_pylist(list(rows.values()), EMPTY.schema)


def read_parts(path: str | os.PathLike[str], names: pa.Table) -> dict[str, list[tuple[float, str]]]:
    """The parts in a CSV file with the columns `vehicle`, `day` and `part`: for each vehicle the changes, in seconds since
    1970.

    Raises
    ------
    FleetError
        A column is missing, or a day is not in the form 2026-03-31.
    """
    of = dict(zip(names["vehicle"].to_pylist(), names["name"].to_pylist()))
    parts: dict[str, list[tuple[float, str]]] = defaultdict(list)
    for line, row in _rows(path, ("day", "part")):
        try:
            day = datetime.datetime.strptime(row["day"], "%Y-%m-%d").replace(tzinfo=datetime.timezone.utc)
        except ValueError:
            raise FleetError(f"{_at(path, line)}: `{row['day']}` is not a day", "write days as 2026-03-31") from None
        parts[of.get(row["vehicle"], row["vehicle"])].append((day.timestamp(), row["part"]))
    return parts


def _rows(path: str | os.PathLike[str], required: tuple[str, ...]) -> Iterator[tuple[int, dict[str, str]]]:
    """The lines of a CSV file with a vehicle, by lowercase headings; the separators are commas or semicolons."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            text = file.read()
    except UnicodeDecodeError as error:
        raise FleetError(f"`{os.fspath(path)}` is not UTF-8: {error}", "save it as CSV in UTF-8") from error
    head = text.partition("\n")[0]
    reader = csv.DictReader(text.splitlines(), delimiter=";" if head.count(";") > head.count(",") else ",")
    titles = [title.strip().lower() for title in reader.fieldnames or ()]
    key = next((name for name in KEYS if name in titles), None)
    missing = [name for name in required if name not in titles]
    if key is None or missing:
        raise FleetError(f"`{os.fspath(path)}` has no column `{missing[0] if key else 'vehicle'}`", f"its columns are {', '.join(titles) or 'none'}")
    reader.fieldnames = titles
    for row in reader:
        of = {name: (value or "").strip() for name, value in row.items() if isinstance(name, str) and not isinstance(value, list)}
        if of[key]:
            yield reader.line_num, of | {"vehicle": of[key]}


def _at(path: str | os.PathLike[str], line: int) -> str:
    return f"`{os.fspath(path)}`, line {line}"


def view(connection: Any, names: str | os.PathLike[str] | None, only: Mapping[str, str]) -> None:
    """Creates the views ``flights``, ``findings`` and ``steps`` of the stored tables, with names and only for the selected
    vehicles."""
    for column in only:
        if column not in ("vehicle", "site", "pilot"):
            raise FleetError(f"there is no filter `{column}`", "filters are `vehicle`, `site` and `pilot`")
        if column != "vehicle" and names is None:
            raise FleetError(f"the filter `{column}` needs a file of names", "name a CSV file with `--names`")
    keep = " AND ".join(f"{column} = {_literal(value)}" for column, value in only.items()) or "true"
    known = "coalesce(a.{0}, b.{0})"
    connection.execute(f"""
        CREATE VIEW flights AS SELECT * FROM (
          SELECT f.* REPLACE (coalesce({known.format("name")}, f.vehicle) AS vehicle),
            {known.format("site")} AS site, {known.format("pilot")} AS pilot
          FROM stored_flights f LEFT JOIN names a ON a.vehicle = f.vehicle LEFT JOIN names b ON b.vehicle = f.vehicle_id) WHERE {keep};
        CREATE VIEW findings AS SELECT g.* REPLACE (f.vehicle AS vehicle) FROM stored_findings g JOIN flights f USING (flight_id);
        CREATE VIEW steps AS FROM stored_steps {"WHERE flight_id IN (SELECT flight_id FROM flights)" if only else ""}
    """)
    if only and not connection.execute("SELECT 1 FROM flights LIMIT 1").fetchone():
        help = "write values as in the file of names, with the same capital letters"
        raise FleetError(f"no flight has {' and '.join(f'{column} `{value}`' for column, value in only.items())}", help)
    if names is not None:
        named = "SELECT 1 FROM stored_flights WHERE vehicle IN (SELECT vehicle FROM names) OR vehicle_id IN (SELECT vehicle FROM names) LIMIT 1"
        if not connection.execute(named).fetchone():
            some = connection.execute("SELECT vehicle FROM stored_flights WHERE vehicle IS NOT NULL LIMIT 1").fetchone()
            help = f"the dataset names vehicles such as `{some[0]}`" if some else "the logs of the dataset do not name their vehicles"
            raise FleetError(f"no vehicle of `{os.fspath(names)}` is in the dataset", help)


def _literal(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"
