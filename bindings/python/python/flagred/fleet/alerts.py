"""Alerts: descriptions of changes, as text, as a JSON document, and passed to a command that sends them."""

from __future__ import annotations

import datetime
import json
import subprocess
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from .changes import Change
from .errors import FleetError

__all__ = ["advice", "alerts", "key", "run_command", "sentence", "to_json"]

OF = {"risk_mean_pct": "mean risk", "risk_max_pct": "highest risk of a flight", "warned_pct": "share of flights that warn"}


def alerts(changes: Sequence[Change], least_pct: float) -> list[Change]:
    """The changes for the worse whose whole interval is above a limit, in percent."""
    return [change for change in changes if change.low_pct > least_pct]


def key(change: Change) -> str:
    """An identifier of a change without its date, because the next run may date the same change slightly differently."""
    who = "fleet" if change.is_fleet else change.vehicles[0]
    return f"{who}: {change.kind} {change.cause or ('of a week' if change.is_fleet else '')}".strip()


def sentence(change: Change) -> str:
    """The description of the change."""
    day = _day(change.since_s)
    rises = "rose" if change.change_pct > 0 else "fell"
    by = f"{abs(change.change_pct):.1f} percentage points ({_range(change)})"
    before, after = change.warned_pct
    if change.kind == "slope":
        grows = "grows riskier" if change.change_pct > 0 else "becomes safer"
        grows += "" if change.is_clear else ", gradually or at once"
        per_week = abs(change.slope_pct_week or 0.0)
        return (
            f"{change.vehicles[0]} {grows}: its {OF[change.measure]} {rises} by {per_week:.2f} percentage points a week, by {abs(change.change_pct):.1f} ({_range(change)}) since {day}. "
            f"Of its flights {before:.0f} % warned in the first third of that time and {after:.0f} % in the last."
        )
    counts = f"{_count(change.flights[0])} before, {_count(change.flights[1])} after"
    warned = f" Flights that warned: {before:.0f} % before, {after:.0f} % after." if change.measure != "warned_pct" else f" It was {before:.0f} % and is {after:.0f} %."
    if change.is_fleet:
        of = f"{len(change.vehicles)} vehicles"
        when = f"With {change.cause}" if change.cause else f"In the week of {day}"
        since = f" since {day}" if change.cause else ""
        others = ""
        if change.others is not None:
            others = f" Vehicles without it changed by {_signed(change.others[0])} ({_signed(change.others[1])} to {_signed(change.others[2])}) in the same time."
        return f"{when} the {OF[change.measure]} of {of} {rises} by {by}{since}, each vehicle compared with itself ({counts}).{warned}{others}"
    steadily = "It does not change steadily" if change.is_clear else "The change may also be gradual: the flights do not show which"
    with_cause = f" with {change.cause}" if change.cause else ""
    return f"{change.vehicles[0]} changed once, on {day}{with_cause}: its {OF[change.measure]} {rises} by {by}. {steadily} ({counts}).{warned}"


def advice(change: Change) -> str:
    """Advice on how to react to the change."""
    if change.change_pct <= 0:
        return "Nothing to do."
    if change.kind == "slope":
        return "Check propellers, motors, bearings and mounts before the next flight. The page of the vehicle shows motors whose command rises relative to the others: check these first."
    if change.is_fleet and change.cause and change.cause.startswith("firmware "):
        return "Do not install this firmware on the other vehicles yet. Compare gains and limits before and after, and read the reports of the worst flights since."
    if change.is_fleet and change.cause is None:
        return "Find out what changed for all vehicles at that time: payload, task, site, pilots or weather that the logs do not report."
    if change.cause:
        return f"Check what was changed on {_day(change.since_s)}: {change.cause}."
    return f"Find out what happened on or before {_day(change.since_s)}: a crash, a repair, another payload or other gains."


def to_json(change: Change, is_new: bool) -> dict[str, Any]:
    """The change for programs."""
    of = asdict(change)
    since = _day(of.pop("since_s"))
    low, high = of.pop("low_pct"), of.pop("high_pct")
    (flights_before, flights_after), (before, after) = of.pop("flights"), of.pop("warned_pct")
    return of | {
        "since": since,
        "interval_pct": [low, high],
        "flights": {"before": flights_before, "after": flights_after},
        "warned_pct": {"before": before, "after": after},
        "is_new": is_new,
        "text": sentence(change),
        "advice": advice(change),
    }


def run_command(command: str, document: dict[str, Any]) -> None:
    """Runs a shell command with the document on its standard input.

    Raises
    ------
    FleetError
        The command failed.
    """
    done = subprocess.run(command, shell=True, input=json.dumps(document).encode(), check=False)
    if done.returncode:
        raise FleetError(f"the alert command failed with exit code {done.returncode}: `{command}`", "the next report runs it again")


def _day(at_s: float) -> str:
    return datetime.datetime.fromtimestamp(at_s, datetime.timezone.utc).date().isoformat()


def _count(flights: int) -> str:
    return f"{flights:,} flight" + ("" if flights == 1 else "s")


def _signed(value: float) -> str:
    return f"{value:.1f}".replace("-", "\u2212")


def _range(change: Change) -> str:
    sign = 1 if change.change_pct > 0 else -1
    low, high = sorted((sign * change.low_pct, sign * change.high_pct))
    return f"{low:.1f} to {high:.1f}"
