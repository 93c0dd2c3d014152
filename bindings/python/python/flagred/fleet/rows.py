"""A log as rows of the tables."""

from __future__ import annotations

import hashlib
import re
from functools import lru_cache
from typing import Any

import numpy as np
import pyarrow as pa

from .. import Profile, __version__, loads, read_log
from .._flight import assessed
from ..types import Assessment, Flight
from .schema import FINDINGS, FLIGHTS, STEPS
from .shards import Job
from .storage import Log

__all__ = ["Rows"]


class Rows:
    """The rows of the logs of one month."""

    def __init__(self) -> None:
        self.flights: list[dict[str, Any]] = []
        self.findings: list[dict[str, Any]] = []
        self.steps: list[tuple[str, pa.Table]] = []

    def tables(self) -> dict[str, pa.Table]:
        """The tables that have rows, by their names."""
        found = {"flights": pa.Table.from_pylist(self.flights, FLIGHTS)}
        if self.findings:
            found["findings"] = pa.Table.from_pylist(self.findings, FINDINGS)
        if self.steps:
            found["steps"] = _steps(self.steps)
        return found


def told(shown: str, log: Log, job: Job) -> dict[str, Any]:
    """The row of a log before it is read."""
    folder = re.search(r"(?:^|/)vehicle=([^/]+)/", shown)
    id = hashlib.sha256(f"{shown}\n{log.identity}".encode()).hexdigest()[:20]
    return {
        "log": shown,
        "bytes": log.bytes,
        "modified_utc": log.modified_us,
        "identity": log.identity,
        "deleted": False,
        "flight_id": id,
        "vehicle": folder and folder[1],
        "profile": job.profile.name,
        "settings": job.settings,
        "flagred": __version__,
    }


def add(rows: dict[str | None, Rows], row: dict[str, Any], log: str | bytes, job: Job) -> None:
    """Assesses a log, by its path or its content, and adds its rows to those of its month."""
    assessment = assessed(read_log(log), job.profile, job.step_s, with_intervals=False)
    row |= _flight(assessment)
    row["vehicle"] = row["vehicle"] or row["vehicle_id"]
    start = row["start_utc"]
    month = None if start is None else str(np.datetime64(start, "us").astype("datetime64[M]"))
    of = rows.setdefault(month, Rows())
    of.flights.append(row)
    of.findings.extend(_findings(assessment, row))
    steps = pa.table(assessment.steps)
    if len(steps):
        of.steps.append((row["flight_id"], steps))


def _flight(assessment: Assessment) -> dict[str, Any]:
    flight, summary = assessment.flight, assessment.summary
    vehicle, report = flight.vehicle, flight.report
    peak, elevated = summary.risk_max, summary.elevated_risk_max
    return {
        "status": "assessed",
        "vehicle_id": vehicle.id,
        "vehicle_id_source": vehicle.id_source,
        "system_id": vehicle.system_id,
        "boot_count": vehicle.boot_count,
        "format": flight.format,
        "kind": None if vehicle.kind == "unknown vehicle" else vehicle.kind,
        "frame": vehicle.frame,
        "firmware": vehicle.firmware,
        "motors": len(flight.motors) or None,
        "start_utc": _start_us(assessment),
        "in_air_s": summary.in_air_s if flight.in_air else None,
        "assessed_s": summary.assessed_s,
        "filled_s": summary.filled_s,
        "wind_m_s": _wind(assessment),
        "verdict": assessment.verdict,
        "reason": assessment.reason,
        "findings": len(assessment.findings) + assessment.findings_left_out,
        "risk_mean_pct": summary.risk_mean_pct,
        "risk_max_pct": peak and peak.value_pct,
        "risk_max_s": peak and peak.t_s,
        "elevated_risk_max_pct": elevated and elevated.value_pct,
        "elevated_risk_max_s": elevated and elevated.t_s,
        "saturated_share": summary.saturated_share,
        **_motors(flight),
        "messages": report.messages,
        "skipped_bytes": report.skipped_bytes,
        "bad_messages": report.bad_messages,
        "truncated": report.truncated,
        "damage": report.reason,
    }


def _motors(flight: Flight) -> dict[str, Any]:
    """The mean command and margin of each motor in the air."""
    times = flight.t_s
    if flight.in_air is None or not flight.motors or len(times) == 0:
        return {}
    in_air = np.zeros(len(times), bool)
    for span in flight.in_air.spans:
        in_air[np.searchsorted(times, span.start_s) : np.searchsorted(times, span.end_s)] = True
    commands = flight.commands[in_air]
    known = np.isfinite(commands)
    if not known.any(axis=0).all():
        return {}
    margins = np.minimum(commands, 1 - commands).mean(axis=0, where=known)
    numbers = [motor.number for motor in flight.motors]
    weakest = int(margins.argmin())
    return {
        "motor_commands": commands.mean(axis=0, where=known).tolist(),
        "motor_margins": margins.tolist(),
        "weakest_motor": numbers[weakest],
        "weakest_margin": float(margins[weakest]),
    }


LAST_US = 253_402_300_800_000_000
"""The year 10000: a later time indicates a damaged clock."""


def _start_us(assessment: Assessment) -> int | None:
    """UTC of the first command or signal, in microseconds since 1970."""
    flight = assessment.flight
    times = flight.t_s
    if flight.utc_at_zero_s is None or len(times) == 0:
        return None
    start_us = round((flight.utc_at_zero_s + float(times[0])) * 1e6)
    return start_us if 0 < start_us < LAST_US else None


def _wind(assessment: Assessment) -> float | None:
    for name in ("wind_m_s", "ekf_wind_m_s"):
        if (signal := assessment.flight._signal(name)) is not None:
            known = signal[1][np.isfinite(signal[1])]
            if len(known):
                return float(known.mean())
    return None


@lru_cache(maxsize=8)
def _rules(profile: Profile) -> list[str]:
    return [rule.text for rule in loads(profile.rules_text).rules]


def _findings(assessment: Assessment, row: dict[str, Any]) -> list[dict[str, Any]]:
    rules = _rules(assessment.profile)
    found = []
    for finding in assessment.findings:
        motor, cause = finding.motor, finding.cause
        found.append(
            {
                "flight_id": row["flight_id"],
                "vehicle": row["vehicle"],
                **{name: getattr(finding, name) for name in _SAME},
                "motor": motor and motor.number,
                "side": motor and motor.side,
                "margin_mean": motor and motor.margin_mean,
                "margin_min": motor and motor.margin_min,
                "rule": cause and rules[cause.rule - 1],
                "cause": cause and f"{cause.input} IS {cause.term}",
            }
        )
    return found


_SAME = ("severity", "measure", "from_s", "raised_s", "failed_s", "to_s", "value_pct", "threshold_pct", "code", "text", "advice")
_STEPS = {"risk": "risk_pct", "elevated_risk": "elevated_risk_pct"}


def _steps(of: list[tuple[str, pa.Table]]) -> pa.Table:
    """The steps of several flights in one table."""
    names = {_STEPS.get(name, name): name for name in of[0][1].column_names}
    steps = pa.concat_tables(table.select([names[name] for name in STEPS.names[1:]]) for _, table in of)
    ids = np.repeat(np.array([id for id, _ in of]), [len(table) for _, table in of])
    columns = [pa.array(ids), *steps.columns]
    return pa.table([column.cast(field.type) for column, field in zip(columns, STEPS)], STEPS)
