"""The report of a fleet: a page that begins with the changes to act on, a page for each vehicle, and a report for each of the
worst flights."""

from __future__ import annotations

import datetime
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from .._core import _page
from .alerts import advice, alerts, key, run_command, sentence, to_json
from .changes import MIN_DAYS, LEVEL, Change, find_changes
from .charts import Point, chart
from .flight_reports import write_flight_reports
from .names import EMPTY, read_names, read_parts
from .news import News, known_before, remember
from .questions import QUESTIONS, ask, open_dataset
from .sections import CAUSES, SECTIONS
from .tables import STYLE, Column, Row, date, day, figures, known, link, log_link, number, section, table, text, verdict
from .vehicle_pages import write_vehicle_pages

__all__ = ["Report", "write_report"]

SHOWN_FLIGHTS, SHOWN_NEW, SHOWN_VEHICLES = 10, 5, 500


@dataclass(frozen=True)
class Report:
    """The results of a report."""

    changes: list[Change]
    """All changes: those of the fleet first, the largest rise first."""
    alerts: list[Change]
    """The rises above the limit, which require action by an operator."""
    document: dict[str, Any]
    """The report as a JSON document for programs: see docs/fleet.md."""
    missing_reports: list[str]
    """Flights whose report could not be written, each with the reason."""


def write_report(
    dataset: str,
    out: str | os.PathLike[str],
    *,
    least_pct: float = 0.0,
    names: str | os.PathLike[str] | None = None,
    only: Mapping[str, str] | None = None,
    parts: str | os.PathLike[str] | None = None,
    worst: int = 0,
    alert_command: str | None = None,
) -> Report:
    """Writes the report of a dataset as an HTML page, and the linked files into the folder ``NAME.files`` beside it.

    Parameters
    ----------
    dataset
        The dataset: a folder, or an address on object storage.
    out
        The page.
    least_pct
        The minimum rise for an alert, in percentage points: of the risk or of the share of flights that warn. The whole 95 %
        interval must be above it.
    names, only
        Names of vehicles, and the vehicles to select, as for :func:`open_dataset`.
    parts
        A CSV file of changed parts: `vehicle`, `day`, `part`.
    worst
        The number of worst flights with a report of the flight. Their logs are read again.
    alert_command
        A shell command to run if there is an alert that the last report did not have. It receives the document as JSON.

    Raises
    ------
    FleetError
        There is no dataset, a file is damaged or invalid, or the command failed.
    """
    page = Path(out)
    files = page.with_name(f"{page.stem}.files")
    connection = open_dataset(dataset, names, only)
    answers: dict[str, list[Row]] = {question: ask(connection, question).to_pylist() for question in QUESTIONS}
    of_parts = read_parts(parts, EMPTY if names is None else read_names(names)) if parts is not None else {}
    changes = find_changes(connection, of_parts)
    found = alerts(changes, least_pct)
    news = known_before(files, connection, [key(change) for change in found])
    reports, missing = write_flight_reports(files, answers["worst"][:worst], dataset)
    answers["vehicles"] = _ordered(answers["vehicles"], changes)
    shown = [row["vehicle"] for row in answers["vehicles"][:SHOWN_VEHICLES]]
    pages = write_vehicle_pages(files, connection, shown, changes, of_parts, reports, page.name)
    name = dataset.rstrip("/").rpartition("/")[2].partition("?")[0] or "fleet"
    document = _document(name, changes, found, answers, news)
    _write(page, _page(name, _body(name, answers, changes, found, news, pages, reports, files.name)))
    if alert_command is not None and any(news.is_new(key(change)) for change in found):
        run_command(alert_command, document)
    remember(files, connection, [key(change) for change in found])
    return Report(changes, found, document, missing)


def _write(path: Path, page: str) -> None:
    unfinished = path.with_name(f".{path.name}.unfinished")
    unfinished.write_text(page, encoding="utf-8")
    os.replace(unfinished, path)


def _document(name: str, changes: Sequence[Change], found: Sequence[Change], answers: Mapping[str, list[Row]], news: News) -> dict[str, Any]:
    return {
        "dataset": name,
        "written_utc": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "last_report_utc": news.last_utc,
        "flights": sum(row["flights"] for row in answers["verdicts"]),
        "vehicles": len(answers["vehicles"]),
        "vehicles_compared": sum(row["days"] >= MIN_DAYS for row in answers["vehicles"]),
        "new_flights": news.flights,
        "new_warned": news.warned,
        "level": LEVEL,
        "alerts": [to_json(change, news.is_new(key(change))) for change in found],
        "other_changes": [to_json(change, False) for change in changes if change not in found],
    }


def _body(
    name: str,
    answers: Mapping[str, list[Row]],
    changes: Sequence[Change],
    found: Sequence[Change],
    news: News,
    pages: Mapping[str, str],
    reports: Mapping[str, str],
    folder: str,
) -> str:
    vehicles, verdicts = answers["vehicles"], answers["verdicts"]
    flights = sum(row["flights"] for row in verdicts)
    warned = sum(row["flights"] for row in verdicts if row["verdict"] in ("WARN", "FAIL"))
    unread = sum(row["logs"] for row in answers["unread"])
    hours = sum(row["in_air_h"] or 0 for row in verdicts)
    starts = [row["first_utc"] for row in vehicles] + [row["last_utc"] for row in vehicles]
    starts = [start for start in starts if start is not None]
    span = f"Flights from {date(min(starts))} to {date(max(starts))}. " if starts else ""
    today = datetime.datetime.now(datetime.timezone.utc).date()
    at = {vehicle: f"{folder}/{file}" for vehicle, file in pages.items()}
    of_flights = {flight: f"{folder}/{file}" for flight, file in reports.items()}
    parts = [
        STYLE,
        f"<h1>Fleet {escape(name)}</h1><p class=soft>{span}Written on {today}.</p>",
        figures(
            {
                "Flights": f"{flights:,}",
                "Flights that warned": f"{warned:,}",
                "Vehicles": f"{len(vehicles):,}",
                "In the air": f"{hours:,.1f} h",
                "Logs not read": f"{unread:,}",
            }
        ),
        "<h2>What to act on</h2>",
        _to_act_on(found, news, at),
        _compared(vehicles),
        _news(news, at, of_flights),
        "<h2>Worst flights</h2>",
        table(answers["worst"][:SHOWN_FLIGHTS], _flight_columns(at, of_flights), "No flight was judged."),
        "<h2>Causes</h2>",
        table(answers["causes"], CAUSES, "No flight warned."),
        "<h2>Vehicles</h2>",
        _vehicles(vehicles, changes, at),
        _weeks(answers["weeks"]),
        _others([change for change in changes if change not in found]),
        "<h2>More</h2>",
    ]
    parts += [section(title, table(answers[question], columns, none)) for title, question, columns, none in SECTIONS]
    parts.append(
        "<p class=soft>Numbers in small print are 95 % intervals. A change is listed if a fleet without changes would show it with a probability of at most "
        f"{100 * LEVEL:g} %; flights of one day and vehicle count as one, and are compared at equal wind and time in the air. Only flights that "
        "were judged for at least 10 s count.</p>"
    )
    return "\n".join(parts)


def _to_act_on(found: Sequence[Change], news: News, at: Mapping[str, str]) -> str:
    if not found:
        return "<p>No change for the worse was found.</p>"
    lines = []
    for change in found:
        title = change.cause or ("The whole fleet" if change.is_fleet else "")
        of = [link(vehicle, at.get(vehicle)) for vehicle in change.vehicles[:20]]
        who = ", ".join(of) + (f" and {len(change.vehicles) - 20} more" if len(change.vehicles) > 20 else "")
        head = f"{escape(title[:1].upper() + title[1:])}: {who}" if change.is_fleet else who
        new = " <span class=new>new</span>" if news.is_new(key(change)) and news.last_utc else ""
        lines.append(f"<li class=fail><b>{head}</b>{new}<br>{escape(sentence(change))}<span class=advice>{escape(advice(change))}</span></li>")
    return f"<ul class=act>{''.join(lines)}</ul>"


def _compared(vehicles: Sequence[Row]) -> str:
    """The number of vehicles with enough flights to find a change. Changes of all other vehicles are unknown."""
    count = sum(row["days"] >= MIN_DAYS for row in vehicles)
    if count == len(vehicles) > 0:
        return ""
    return f"<p class=soft>{count:,} of {len(vehicles):,} vehicles have flights on at least {MIN_DAYS} days. For the others, no change can be detected yet.</p>"


def _others(changes: Sequence[Change]) -> str:
    if not changes:
        return ""
    lines = "".join(f"<li class={'good' if change.change_pct < 0 else 'warn'}>{escape(sentence(change))}</li>" for change in changes)
    return f"<h2>Other changes</h2><ul class=findings>{lines}</ul>"


def _news(news: News, at: Mapping[str, str], reports: Mapping[str, str]) -> str:
    if news.last_utc is None:
        return ""
    counts = f"{news.flights:,} new flights, {news.warned:,} of them warned."
    vehicles = ", ".join(link(vehicle, at.get(vehicle)) for vehicle in news.vehicles[:20])
    of = f" New vehicles: {vehicles}." if vehicles else ""
    worst = table(news.worst[:SHOWN_NEW], _flight_columns(at, reports), "") if news.worst else ""
    return f"<h2>New since the report of {escape(news.last_utc[:10])}</h2><p>{counts}{of}</p>{worst}"


def vehicle_column(at: Mapping[str, str]) -> Column:
    def cell(row: Row) -> str:
        vehicle = row["vehicle"]
        return "<span class=soft>not named in the log</span>" if vehicle is None else link(vehicle, at.get(vehicle))

    return "Vehicle", "name", cell


def _flight_columns(at: Mapping[str, str], reports: Mapping[str, str]) -> Sequence[Column]:
    def words(row: Row) -> str:
        what = "" if row["what"] is None else escape(row["what"])
        advice = "" if row["advice"] is None else f"<small>{escape(row['advice'])}</small>"
        report = reports.get(row["flight_id"])
        return f"{what}{advice}<small>{link('report of ' + Path(row['log']).name, report) if report else log_link(row['log'])}</small>"

    return (
        verdict("Verdict", "verdict"),
        vehicle_column(at),
        day("Day", "start_utc"),
        number("Highest risk, %", "risk_max_pct", 0),
        ("What happened", "words", words),
    )


def _ordered(rows: Sequence[Row], changes: Sequence[Change]) -> list[Row]:
    """Vehicles that changed for the worse first, then those that warn most."""
    worse = {change.vehicles[0]: -change.change_pct for change in changes if not change.is_fleet and change.change_pct > 0}
    return sorted(rows, key=lambda row: worse.get(row["vehicle"], 0.0))


def _vehicles(rows: Sequence[Row], changes: Sequence[Change], at: Mapping[str, str]) -> str:
    trends: dict[str, str] = {}
    for change in changes:
        if not change.is_fleet:
            up = change.change_pct > 0
            trends[change.vehicles[0]] = ("grows riskier" if up else "becomes safer") if change.kind == "slope" else f"{'rose' if up else 'fell'} once, {date(_at(change))}"
    columns = [vehicle_column(at)]
    columns += [text(name.capitalize(), name, "") for name in ("site", "pilot") if any(row[name] for row in rows)]
    columns += [
        number("Flights", "flights"),
        ("Warned", "n", lambda row: f"{row['warned']:,}<small>{100 * row['warned'] / row['flights']:.0f} %</small>"),
        number("FAIL", "failed"),
        number("Mean risk, %", "risk_mean_pct", 1),
        ("Change", "", lambda row: escape(trends.get(row["vehicle"], ""))),
        ("Weakest motor", "n", lambda row: "NA" if row["weakest_motor"] is None else f"{row['weakest_motor']}<small>margin {known(row['weakest_margin'], 2)}</small>"),
        day("Last", "last_utc"),
    ]
    search = "<p><input type=search id=find placeholder='Find a vehicle, site or pilot' aria-label='Find a vehicle, site or pilot'></p>" if len(rows) > 10 else ""
    return search + table(rows[:SHOWN_VEHICLES], columns, "No judged flight names its vehicle.", "vehicles") + (SEARCH if search else "")


SEARCH = """<script>document.getElementById("find").addEventListener("input",(event)=>{const wanted=event.target.value.toLowerCase();
for(const row of document.querySelectorAll("#vehicles tbody tr"))row.hidden=!row.textContent.toLowerCase().includes(wanted)})</script>"""


def _at(change: Change) -> datetime.datetime:
    return datetime.datetime.fromtimestamp(change.since_s, datetime.timezone.utc)


def _weeks(rows: Sequence[Row]) -> str:
    if len(rows) < 2:
        return ""
    points = []
    for row in rows:
        at = datetime.datetime.combine(row["week"], datetime.time(), datetime.timezone.utc).timestamp()
        words = f"week of {row['week']}: {row['warned_pct']:.1f} % ({row['low_pct']:.1f} to {row['high_pct']:.1f}) of {row['flights']} flights"
        points.append(Point(at, row["warned_pct"], row["low_pct"], row["high_pct"], "risk", words))
    return "<h2>By week</h2>" + chart("Share of flights with WARN or FAIL in each week, %, with its 95 % interval", points)
