"""The tables of the fleet's page that only show the answer to a question."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from .tables import Column, day, log, number, share, text, verdict

__all__ = ["CAUSES", "SECTIONS"]

CAUSES: Sequence[Column] = (
    ("What happened", "words", lambda row: f"{escape(row['what'])}<small>{escape(row['advice'] or '')}</small>"),
    number("Flights", "flights"),
    number("Vehicles", "vehicles"),
    number("Findings", "findings"),
    share("Share of findings, %", "share_pct", "low_pct", "high_pct"),
)
WARNED = share("Warned, %", "warned_pct", "low_pct", "high_pct")
SECTIONS: Sequence[tuple[str, str, Sequence[Column], str]] = (
    (
        "Verdicts",
        "verdicts",
        (verdict("Verdict", "verdict"), number("Flights", "flights"), share("Share, %", "share_pct", "low_pct", "high_pct"), number("In the air, h", "in_air_h", 1)),
        "No flight was assessed.",
    ),
    (
        "Motors at their limits",
        "motors",
        (
            number("Motor", "motor"),
            text("Limit", "side"),
            number("Flights", "flights"),
            number("Vehicles", "vehicles"),
            number("Findings", "findings"),
            number("Margin (median)", "margin_median", 3),
            number("Minutes", "minutes", 1),
        ),
        "No finding names a motor.",
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
        "No log reports the wind.",
    ),
    (
        "Longest at risk",
        "time_at_risk",
        (
            log("Log", "log"),
            text("Vehicle", "vehicle", "not named in the log"),
            day("Day", "start_utc"),
            verdict("Verdict", "verdict"),
            number("At risk, s", "at_risk_s", 1),
            number("In the air, s", "in_air_s", 1),
        ),
        "No flight reached a risk that raises a warning.",
    ),
    ("Flights without a verdict", "no_verdict", (text("Reason", "reason"), number("Flights", "flights"), log("Such as", "example")), "Every flight has a verdict."),
    (
        "Logs that were not read",
        "unread",
        (text("Status", "status"), text("Reason", "error"), number("Logs", "logs"), log("Such as", "example")),
        "Every log was read.",
    ),
)
