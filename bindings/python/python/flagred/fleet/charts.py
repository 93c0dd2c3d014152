"""Pictures of the fleet report: values over weeks with their intervals, as SVG."""

from __future__ import annotations

import datetime
import math
from collections.abc import Sequence
from html import escape
from typing import NamedTuple

__all__ = ["Point", "intervals"]

WIDTH, HEIGHT = 320, 150
LEFT, RIGHT, TOP, BOTTOM = 34, 8, 10, 20


class Point(NamedTuple):
    """A value with its interval."""

    day: datetime.date
    value: float
    low: float
    high: float
    flights: int
    """How many flights it stands on."""


def intervals(points: Sequence[Point], title: str, kind: str) -> str:
    """Values in per cent over days, each with its interval as a bar. ``kind`` is a class of the style sheet, which gives the colour."""
    first, last = points[0].day.toordinal(), points[-1].day.toordinal()
    top = min(100, 10 * math.ceil(max(point.value for point in points) * 0.13 + 0.1))

    def x(day: datetime.date) -> float:
        return LEFT + 6 + (day.toordinal() - first) / max(1, last - first) * (WIDTH - LEFT - RIGHT - 12)

    def y(value: float) -> float:
        return TOP + (1 - min(max(value, 0.0), top) / top) * (HEIGHT - TOP - BOTTOM)

    parts = [f"<svg class={kind} viewBox='0 0 {WIDTH} {HEIGHT}' role=img><title>{escape(title)}</title>"]
    for share in (0.0, 0.5, 1.0):
        level = y(share * top)
        parts.append(f"<line class=grid x1={LEFT} x2={WIDTH - RIGHT} y1={level:.1f} y2={level:.1f} />")
        parts.append(f"<text x={LEFT - 5} y={level + 4:.1f} text-anchor=end>{share * top:g}</text>")
    for point in points:
        at = x(point.day)
        told = f"week of {point.day}: {point.value:.1f} % ({point.low:.1f} to {point.high:.1f}), {point.flights} flights"
        bar = f"<line class=bar x1={at:.1f} x2={at:.1f} y1={y(point.low):.1f} y2={y(point.high):.1f} />"
        dot = f"<circle class=dot cx={at:.1f} cy={y(point.value):.1f} r=2.6 />"
        parts.append(f"<g>{bar}{dot}<title>{told}</title></g>")
    parts.append(f"<text x={LEFT} y={HEIGHT - 5}>{points[0].day}</text>")
    parts.append(f"<text x={WIDTH - RIGHT} y={HEIGHT - 5} text-anchor=end>{points[-1].day}</text></svg>")
    return "".join(parts)
