"""Tables of the fleet's pages, as HTML. On a phone each row becomes a block, so that nothing is cut off."""

from __future__ import annotations

import datetime
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

__all__ = ["STYLE", "Cell", "Column", "Row", "date", "day", "figures", "known", "link", "log", "log_link", "number", "section", "share", "table", "text", "verdict"]

Row = dict[str, Any]
Cell = Callable[[Row], str]
Column = tuple[str, str, Cell]
"""Title, class, and a function that returns the cell of a row."""

STYLE = """<style>a{color:inherit}small{color:var(--soft);font-size:.85em;white-space:nowrap}td.n small{display:block}td.log{min-width:12rem}
td.words{min-width:16rem}td.words small,.advice{display:block;color:var(--soft);white-space:normal}
ul.act{list-style:none;margin:.5rem 0;padding:0}ul.act li{background:var(--shade);border-left:.3rem solid var(--c);border-radius:.2rem;padding:.6rem .8rem;margin:.5rem 0}
ul.act b{font-size:1.05rem}ul.act .advice{margin-top:.2rem}.new{color:var(--value);font-weight:700;font-size:.85em}
details{margin:.7rem 0;border-bottom:1px solid var(--grid);padding-bottom:.4rem}summary{cursor:pointer;font-weight:600}
input[type=search]{font:inherit;color:inherit;background:var(--shade);border:1px solid var(--rule);border-radius:.3rem;padding:.3rem .5rem;width:min(22rem,100%)}
.plot .dot{stroke-width:6;stroke-linecap:round;stroke-dasharray:none;opacity:.9}.plot .dot.under{stroke:var(--paper);stroke-width:8}
.mark{position:absolute;top:.3rem;font-size:.75rem;line-height:1.15;color:var(--soft);padding-left:.25rem;white-space:nowrap;max-width:45%;overflow:hidden;text-overflow:ellipsis}
@media(min-width:40.01rem){td.n+td:not(.n),th.n+th:not(.n){padding-left:.8rem}}
@media screen and (max-width:40rem){dl.figures{grid-template-columns:1fr 1fr}dl.figures div:last-child:nth-child(odd){grid-column:1/-1}
table.cards thead{display:none}table.cards tr{display:grid;grid-template-columns:1fr 1fr;gap:.1rem 1.2rem;padding:.5rem 0;border-bottom:1px solid var(--rule)}
table.cards tr[hidden],table.cards td:empty{display:none}
table.cards td{display:flex;flex-wrap:wrap;justify-content:flex-end;border:0;padding:.1rem 0;min-width:0;text-align:right;white-space:normal}
table.cards td::before{content:attr(data-title);color:var(--soft);text-align:left;margin-right:auto;padding-right:.6rem}
table.cards td.words,table.cards td.log{display:block;grid-column:1/-1;text-align:left}
table.cards td.words::before,table.cards td.log::before{content:none}table.cards td.n small{display:inline;margin-left:.4em}}</style>"""


def table(rows: Iterable[Row], columns: Sequence[Column], none: str, id: str = "") -> str:
    """A table, or a sentence if there are no rows."""
    body = "".join(
        "<tr>" + "".join(f"<td class='{kind}' data-title='{escape(title, quote=True)}'>{cell(row)}</td>" for title, kind, cell in columns) + "</tr>"
        for row in rows
    )
    if not body:
        return f"<p class=soft>{none}</p>"
    head = "".join(f"<th class='{kind}'>{escape(title)}</th>" for title, kind, _ in columns)
    return f"<div class=scroll><table class=cards{f' id={id}' if id else ''}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"


def figures(values: Mapping[str, str]) -> str:
    """Key figures in boxes."""
    return "<dl class=figures>" + "".join(f"<div><dt>{escape(key)}</dt><dd>{value}</dd></div>" for key, value in values.items()) + "</dl>"


def section(title: str, body: str) -> str:
    """A part of a page that is initially collapsed."""
    return f"<details><summary>{escape(title)}</summary>{body}</details>"


def known(value: float | None, digits: int) -> str:
    # Adding 0 removes the minus sign of a number that is rounded to 0.
    return "NA" if value is None else f"{round(value, digits) + 0.0:,.{digits}f}"


def text(title: str, name: str, none: str = "NA") -> Column:
    return title, "", lambda row: f"<span class=soft>{none}</span>" if row[name] is None else escape(str(row[name]))


def number(title: str, name: str, digits: int = 0) -> Column:
    return title, "n", lambda row: known(row[name], digits)


def share(title: str, value: str, low: str, high: str) -> Column:
    """A number, with its interval in smaller print."""
    return title, "n", lambda row: f"{known(row[value], 1)}<small>{known(row[low], 1)} to {known(row[high], 1)}</small>"


def date(moment: datetime.datetime | datetime.date | None) -> str:
    if isinstance(moment, datetime.datetime):
        moment = moment.astimezone(datetime.timezone.utc).date()
    return "NA" if moment is None else moment.isoformat()


def day(title: str, name: str) -> Column:
    return title, "n", lambda row: date(row[name])


def link(shown: str, address: str | None) -> str:
    """Text, as a link if there is an address."""
    return escape(shown) if address is None else f"<a href='{escape(address, quote=True)}'>{escape(shown)}</a>"


def log_link(path: str) -> str:
    """A log, as a link if a browser can open it."""
    return link(path, Path(path).as_uri() if path.startswith("/") else None)


def log(title: str, name: str) -> Column:
    return title, "log", lambda row: log_link(row[name])


def verdict(title: str, name: str) -> Column:
    return title, "", lambda row: f"<span class='badge {row[name].lower()}'>{escape(row[name])}</span>"
