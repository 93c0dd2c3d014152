"""The report of a fleet: one page that needs nothing beside it."""

from __future__ import annotations

import datetime
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

from .._core import _page
from .charts import Point, intervals
from .questions import QUESTIONS, ask, open_dataset

__all__ = ["rising", "write_report"]

SHOWN_VEHICLES = 12
"""Vehicles with a picture of their own: those that rise most surely."""
SHOWN_TRENDS = 50

Row = dict[str, Any]


def rising(dataset: str | Any, limit_pct_week: float = 0.0) -> list[Row]:
    """The vehicles whose risk rises faster than a limit, as far as their flights can tell.

    The whole 95 % interval of the slope lies above the limit. Of many vehicles whose risk does not rise at all, 2.5 % still pass a
    limit of 0 by chance: choose one that matters.

    Parameters
    ----------
    dataset
        The dataset, or a connection that :func:`open_dataset` gave.
    limit_pct_week
        The limit, in per cent of risk a week.
    """
    rows: list[Row] = ask(dataset, "trends").to_pylist()
    return [row for row in rows if row["low_pct_week"] is not None and row["low_pct_week"] > limit_pct_week]


def write_report(dataset: str, out: str | os.PathLike[str], limit_pct_week: float | None = None) -> list[Row]:
    """Writes the report of a dataset as one HTML page. Gives the vehicles that :func:`rising` finds; none without a limit.

    Parameters
    ----------
    dataset
        The dataset: a folder, or an address on object storage.
    out
        The page.
    limit_pct_week
        From which slope on vehicles are listed as rising, in per cent of risk a week.
    """
    connection = open_dataset(dataset)
    answers: dict[str, list[Row]] = {question: ask(connection, question).to_pylist() for question in QUESTIONS}
    alerts = [] if limit_pct_week is None else rising(connection, limit_pct_week)
    name = dataset.rstrip("/").rpartition("/")[2].partition("?")[0] or "fleet"
    page = _page(name, _body(name, answers, alerts, limit_pct_week))
    path = Path(out)
    unfinished = path.with_name(f".{path.name}.unfinished")
    unfinished.write_text(page, encoding="utf-8")
    os.replace(unfinished, path)
    return alerts


STYLE = """<style>.charts{display:grid;grid-template-columns:repeat(auto-fill,minmax(17rem,1fr));gap:.8rem}
.charts figure{margin:0}.charts figcaption{margin:0 0 .2rem}.charts svg{width:100%;height:auto;display:block;background:var(--shade);border-radius:.4rem}
.charts text{fill:var(--soft);font:11px system-ui,sans-serif}.charts .bar{stroke:var(--c);stroke-width:1.5}.charts .dot{fill:var(--c)}
.charts .grid{stroke:var(--grid)}.charts .fit{stroke:var(--ink);stroke-dasharray:4 3}a{color:inherit}td.log{min-width:12rem}</style>"""


def _body(name: str, answers: dict[str, list[Row]], alerts: list[Row], limit: float | None) -> str:
    verdicts = answers["verdicts"]
    read = sum(row["flights"] for row in verdicts)
    unread = sum(row["logs"] for row in answers["unread"])
    hours = sum(row["in_air_h"] or 0 for row in verdicts)
    parts = [
        STYLE,
        f"<h1>{escape(name)}</h1>",
        _figures({"flights": f"{read:,}", "in the air": f"{hours:,.1f} h", "logs without an answer": f"{unread:,}"}),
        _alerts(alerts, limit),
        "<h2>Verdicts</h2>",
        _table(verdicts, VERDICTS, "No flight was assessed."),
        _weeks(answers["weeks"]),
        _trends(answers["trends"], answers["vehicle_weeks"]),
    ]
    for title, question, columns, none in SECTIONS:
        parts += [f"<h2>{title}</h2>", _table(answers[question], columns, none)]
    parts.append(
        "<p class=soft>Intervals hold 95 %: of shares those of Wilson, of means and slopes those of Student. Flights of one vehicle are "
        "taken as independent of each other. Trends take flights that were judged for at least 10 s.</p>"
    )
    return "\n".join(parts)


def _figures(figures: dict[str, str]) -> str:
    return "<dl class=figures>" + "".join(f"<div><dt>{escape(key)}</dt><dd>{value}</dd></div>" for key, value in figures.items()) + "</dl>"


def _alerts(alerts: list[Row], limit: float | None) -> str:
    if limit is None:
        return ""
    if not alerts:
        return f"<p>No vehicle's risk rises surely by more than {limit:g} % a week.</p>"
    lines = (
        f"<li class=fail><b>{escape(row['vehicle'])}</b> rises by {_slope(row)} % a week, "
        f"by {row['flights']} flights</li>"
        for row in alerts
    )
    return f"<ul class=findings>{''.join(lines)}</ul>"


def _weeks(rows: list[Row]) -> str:
    if len(rows) < 2:
        return ""
    shares = [Point(row["week"], row["warned_pct"], row["low_pct"], row["high_pct"], row["flights"]) for row in rows]
    picture = intervals(shares, "share of flights that warned, %", "risk")
    return f"<h2>By week</h2><div class=charts>{_figure('Share of flights with WARN or FAIL, %', picture)}</div>"


def _trends(trends: list[Row], weeks: list[Row]) -> str:
    of = defaultdict(list)
    for row in weeks:
        of[row["vehicle"]].append(Point(row["week"], row["mean_pct"], row["low_pct"], row["high_pct"], row["flights"]))
    pictures = []
    for row in trends[:SHOWN_VEHICLES]:
        if len(of[row["vehicle"]]) > 1:
            caption = f"{row['vehicle']}: {_slope(row)} % a week"
            pictures.append(_figure(caption, intervals(of[row["vehicle"]], f"mean risk of {row['vehicle']}, %", "value")))
    charts = f"<p class=soft>Mean risk of a week in %, of the vehicles that rise most surely.</p><div class=charts>{''.join(pictures)}</div>"
    none = "No vehicle has 8 judged flights in 3 weeks."
    return f"<h2>Vehicles</h2>{charts if pictures else ''}{_table(trends[:SHOWN_TRENDS], TRENDS, none)}"


def _figure(caption: str, picture: str) -> str:
    return f"<figure><figcaption>{escape(caption)}</figcaption>{picture}</figure>"


Cell = Callable[[Row], str]


def _table(rows: Iterable[Row], columns: Sequence[tuple[str, str, Cell]], none: str) -> str:
    """A table: columns by title, class and what stands in a row."""
    body = "".join("<tr>" + "".join(f"<td class='{kind}'>{cell(row)}</td>" for _, kind, cell in columns) + "</tr>" for row in rows)
    if not body:
        return f"<p class=soft>{none}</p>"
    head = "".join(f"<th class='{kind}'>{escape(title)}</th>" for title, kind, _ in columns)
    return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"


def _known(value: float | None, digits: int) -> str:
    # Without a minus before zeros alone.
    return "NA" if value is None else f"{round(value, digits) + 0.0:,.{digits}f}"


def _span(row: Row, value: str, low: str, high: str, digits: int = 1) -> str:
    return f"{_known(row[value], digits)} ({_known(row[low], digits)} to {_known(row[high], digits)})"


def _slope(row: Row) -> str:
    return _span(row, "slope_pct_week", "low_pct_week", "high_pct_week", 2)


def text(title: str, name: str) -> tuple[str, str, Cell]:
    return title, "", lambda row: "NA" if row[name] is None else escape(str(row[name]))


def number(title: str, name: str, digits: int = 0) -> tuple[str, str, Cell]:
    return title, "n", lambda row: _known(row[name], digits)


def span(title: str, value: str, low: str, high: str) -> tuple[str, str, Cell]:
    return title, "n", lambda row: _span(row, value, low, high)


def day(title: str, name: str) -> tuple[str, str, Cell]:
    def cell(row: Row) -> str:
        moment = row[name]
        return "NA" if moment is None else moment.astimezone(datetime.timezone.utc).strftime("%Y-%m-%d")

    return title, "n", cell


def log(title: str, name: str) -> tuple[str, str, Cell]:
    """A log, as a link where a browser could open it."""

    def cell(row: Row) -> str:
        path = row[name]
        if not path.startswith("/"):
            return escape(path)
        return f"<a href='{escape(Path(path).as_uri(), quote=True)}'>{escape(path)}</a>"

    return title, "log", cell


def verdict(title: str, name: str) -> tuple[str, str, Cell]:
    return title, "", lambda row: f"<span class='badge {row[name].lower()}'>{escape(row[name])}</span>"


VERDICTS = (
    verdict("Verdict", "verdict"),
    number("Flights", "flights"),
    span("Share, %", "share_pct", "low_pct", "high_pct"),
    number("In the air, h", "in_air_h", 1),
)
TRENDS = (
    text("Vehicle", "vehicle"),
    number("Flights", "flights"),
    number("Mean risk, %", "risk_mean_pct", 1),
    ("Slope, % a week", "n", _slope),
    day("First", "first_utc"),
    day("Last", "last_utc"),
)
WARNED = span("Warned, %", "warned_pct", "low_pct", "high_pct")
SECTIONS: tuple[tuple[str, str, Sequence[tuple[str, str, Cell]], str], ...] = (
    (
        "Motors",
        "motors",
        (
            number("Motor", "motor"),
            text("Limit", "side"),
            number("Findings", "findings"),
            number("Flights", "flights"),
            number("Vehicles", "vehicles"),
            number("Margin (median)", "margin_median", 3),
            number("Minutes", "minutes", 1),
        ),
        "No finding names a motor.",
    ),
    (
        "Rules",
        "rules",
        (text("Finding", "code"), text("Rule", "rule"), number("Findings", "findings"), span("Share, %", "share_pct", "low_pct", "high_pct"), number("Flights", "flights")),
        "No finding names a rule.",
    ),
    (
        "Firmware",
        "firmware",
        (
            text("Firmware", "firmware"),
            number("Flights", "flights"),
            number("Vehicles", "vehicles"),
            number("Highest risk (median), %", "risk_max_median_pct", 1),
            number("95 % of flights below, %", "risk_max_p95_pct", 1),
            WARNED,
            day("First flight", "first_utc"),
        ),
        "No flight was judged.",
    ),
    (
        "Wind",
        "wind",
        (
            ("Wind, m/s", "n", lambda row: f"{row['from_m_s']} and more" if row["from_m_s"] == 12 else f"{row['from_m_s']} to {row['from_m_s'] + 3}"),
            number("Flights", "flights"),
            number("Mean risk, %", "risk_mean_pct", 1),
            WARNED,
        ),
        "No log tells the wind.",
    ),
    (
        "Longest at risk",
        "time_at_risk",
        (
            log("Log", "log"),
            text("Vehicle", "vehicle"),
            day("Day", "start_utc"),
            verdict("Verdict", "verdict"),
            number("At risk, s", "at_risk_s", 1),
            number("In the air, s", "in_air_s", 1),
        ),
        "No flight was at a risk that warns.",
    ),
    (
        "Worst flights",
        "worst",
        (
            verdict("Verdict", "verdict"),
            log("Log", "log"),
            text("Vehicle", "vehicle"),
            day("Day", "start_utc"),
            number("Highest risk, %", "risk_max_pct", 1),
            number("Elevated risk, %", "elevated_risk_max_pct", 1),
            text("Firmware", "firmware"),
        ),
        "No flight was judged.",
    ),
    ("Without a verdict", "no_verdict", (text("Reason", "reason"), number("Flights", "flights"), log("Such as", "example")), "Every flight has a verdict."),
    (
        "Without an answer",
        "unread",
        (text("What", "status"), text("Why", "error"), number("Logs", "logs"), log("Such as", "example")),
        "Every log was read.",
    ),
)
