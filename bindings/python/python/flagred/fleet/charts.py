"""Charts of the fleet's pages: values over days, in the style of a flight's report."""

from __future__ import annotations

import datetime
import math
from collections.abc import Sequence
from html import escape
from typing import NamedTuple

__all__ = ["Mark", "Point", "chart"]


class Point(NamedTuple):
    """A value at a time, with its interval or range."""

    at_s: float
    """Seconds since 1970."""
    value: float
    low: float
    high: float
    kind: str
    """A class of the style sheet, which defines the colour."""
    words: str
    """The text of the tooltip."""


class Mark(NamedTuple):
    """A change at a time, such as a new firmware."""

    at_s: float
    name: str


def _months(begin: datetime.date, end: datetime.date) -> list[float]:
    """The beginnings of the months after a day until another, in seconds since 1970."""
    firsts = ((month // 12, month % 12 + 1) for month in range(12 * begin.year + begin.month, 12 * end.year + end.month))
    return [datetime.datetime(year, month, 1, tzinfo=datetime.timezone.utc).timestamp() for year, month in firsts]


def chart(caption: str, points: Sequence[Point], marks: Sequence[Mark] = (), line: Sequence[tuple[float, float]] = (), large: bool = True) -> str:
    """Draws points over days, each with its interval as a bar; marks, with names only in a large chart; and a line."""
    if not points:
        return ""
    first, last = min(point.at_s for point in points), max(point.at_s for point in points)
    span = max(last - first, 1.0)
    highest = max(max(point.high, point.value) for point in points)
    step = next(step for step in (1, 2, 5, 10, 25, 50, 1e9) if step * 4 >= min(highest, 100))
    top = step * math.ceil(min(highest, 100) / step) or step

    def x(at_s: float) -> float:
        return 15 + 970 * (at_s - first) / span

    def y(value: float) -> float:
        return 100 - 100 * min(max(value, 0.0), top) / top

    levels = [step * i for i in range(round(top / step) + 1)]
    parts = [f"<path class=grid d='M0 {y(level):.1f}H1000' />" for level in levels]
    for mark in marks:
        parts.append(f"<path class=event d='M{x(mark.at_s):.1f} 0V100'><title>{escape(mark.name)}</title></path>")
    if line:
        parts.append("<path class='line mean' d='M" + "L".join(f"{x(at):.1f} {y(value):.1f}" for at, value in line) + "' />")
    for point in points:
        at, bar = x(point.at_s), f"M{x(point.at_s):.1f} {y(point.low):.1f}V{y(point.high):.1f}"
        dot = f"M{at:.1f} {y(point.value):.1f}h0"
        title = f"<title>{escape(point.words)}</title>"
        parts.append(f"<g class={point.kind}><path class=line d='{bar}' /><path class='dot under' d='{dot}' /><path class=dot d='{dot}'>{title}</path></g>")
    labels = "".join(f"<span class=y style='bottom:{100 * level / top:.4g}%'>{level:g}</span>" for level in levels)
    names = []
    for mark in marks if large else ():
        share = x(mark.at_s) / 10
        side = f"left:{share:.1f}%" if share < 60 else f"right:{100 - share:.1f}%;padding-right:.25rem"
        names.append(f"<span class=mark style='{side}'>{escape(mark.name)}</span>")
    begin, end = (datetime.datetime.fromtimestamp(at, datetime.timezone.utc).date() for at in (first, last))
    times = f"<span style='left:0;transform:none'>{begin}</span>" + (f"<span class=end style='left:100%'>{end}</span>" if end != begin else "")
    # Beginnings of months between the dates at the ends, each of which takes a quarter of the width on a phone.
    months = [at for at in _months(begin, end) if 300 <= x(at) <= 700]
    for at in months[:: math.ceil(len(months) / 4) or 1]:
        month = datetime.datetime.fromtimestamp(at, datetime.timezone.utc)
        parts.append(f"<path class=grid d='M{x(at):.1f} 0V100' />")
        times += f"<span style='left:{x(at) / 10:.1f}%'>{month:%b}</span>"
    picture = f"<svg class=plot viewBox='0 0 1000 100' preserveAspectRatio=none role=img aria-label='{escape(caption, quote=True)}'>{''.join(parts)}</svg>"
    frame = f"<div class=frame><div class=area>{picture}{''.join(names)}</div>{labels}</div><div class=times>{times}</div>"
    return f"<figure{' class=large' if large else ''}><figcaption>{escape(caption)}</figcaption>{frame}</figure>"
