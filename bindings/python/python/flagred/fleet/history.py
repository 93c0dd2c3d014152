"""The flights of each vehicle over time, for the search for changes: compared at equal wind and time in the air."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["MEASURES", "History", "histories", "marks"]

MEASURES = ("risk_mean_pct", "risk_max_pct", "warned_pct")
"""The columns of ``History.values``: mean and highest risk of a flight, and the share of flights with WARN or FAIL."""
DAY_S = 86_400
MIN_DIFFERENCES = 60
"""The minimum number of pairs of successive flights with which the influence of wind and time in the air is estimated."""

Reals = NDArray[np.float64]
QUERY = """
SELECT vehicle, epoch(start_utc) AS start_s, coalesce(firmware, '') AS firmware, wind_m_s, in_air_s, risk_mean_pct, risk_max_pct,
  1e2 * (verdict IN ('WARN', 'FAIL'))::INT AS warned_pct
FROM judged WHERE vehicle IS NOT NULL AND start_utc IS NOT NULL AND risk_mean_pct IS NOT NULL AND risk_max_pct IS NOT NULL
ORDER BY vehicle, start_utc, flight_id
"""


@dataclass(frozen=True)
class History:
    """The days of a vehicle. Flights of one day with one firmware are one row: they share weather, site, task and often the
    pilot."""

    vehicle: str
    start_s: Reals
    """The start of the first flight of each row, in seconds since 1970."""
    values: Reals
    """The ``MEASURES``, one row per day: means of its flights, adjusted to the mean wind and time in the air of the fleet."""
    flights: NDArray[np.int64]
    """The number of flights in each row."""
    warned: NDArray[np.float64]
    """The number of them that warned."""
    firmware: NDArray[np.object_]

    def __len__(self) -> int:
        return len(self.start_s)

    @property
    def weeks(self) -> Reals:
        """The time of each row in weeks."""
        return self.start_s / (7 * DAY_S)


def histories(connection: Any) -> tuple[list[History], bool]:
    """The history of each vehicle, and whether it is adjusted: a small fleet has too few flights to estimate the influence
    of the wind."""
    table = connection.sql(QUERY).to_arrow_table()
    if not len(table):
        return [], False
    columns = {name: table[name].to_numpy() for name in table.column_names}
    vehicle, start_s = columns["vehicle"], columns["start_s"]
    is_warned = columns["warned_pct"] / 100
    values = np.column_stack([columns[name] for name in MEASURES])
    influences = _influences(columns["wind_m_s"], columns["in_air_s"])
    same = vehicle[1:] == vehicle[:-1]
    # Uses the differences between successive flights of a vehicle, so that the level, trends and rare steps of its risk do not
    # count as influence of the wind.
    across, up = np.diff(influences, axis=0)[same], np.diff(values, axis=0)[same]
    is_adjusted = len(across) >= MIN_DIFFERENCES
    if is_adjusted:
        slopes, *_ = np.linalg.lstsq(across, up, rcond=1e-8)
        values = values - (influences - influences.mean(axis=0)) @ slopes
    day = np.floor(start_s / DAY_S)
    is_new = np.ones(len(vehicle), bool)
    is_new[1:] = ~same | (day[1:] != day[:-1]) | (columns["firmware"][1:] != columns["firmware"][:-1])
    begins = np.flatnonzero(is_new)
    flights = np.diff([*begins, len(vehicle)])
    means = np.add.reduceat(values, begins, axis=0) / flights[:, None]
    warned = np.add.reduceat(is_warned, begins)
    names, firmware, start_s = vehicle[begins], columns["firmware"][begins], start_s[begins]
    ends = [*(np.flatnonzero(names[1:] != names[:-1]) + 1), len(names)]
    found = []
    for begin, end in zip([0, *ends], ends):
        part = slice(begin, end)
        found.append(History(names[begin], start_s[part], means[part], flights[part], warned[part], firmware[part]))
    return found, is_adjusted


def _influences(wind_m_s: Reals, in_air_s: Reals) -> Reals:
    """The covariates of a flight: wind, its square, whether the wind is known, and time in the air."""
    is_known = np.isfinite(wind_m_s)
    wind = np.where(is_known, wind_m_s, 0)
    air = np.log(np.maximum(np.where(np.isfinite(in_air_s), in_air_s, 1), 1))
    return np.column_stack([wind, wind**2, is_known, air])


def marks(history: History, parts: dict[str, list[tuple[float, str]]]) -> list[tuple[int, str]]:
    """The changes of firmware and parts of a vehicle: the first row after each, and its name.

    A return to an earlier firmware is not a mark.
    """
    found, known = [], ""
    seen: set[str] = set()
    for row, firmware in enumerate(history.firmware):
        if firmware and firmware != known:
            if known and firmware not in seen:
                found.append((row, f"firmware {firmware}"))
            known = firmware
            seen.add(firmware)
    for since_s, part in parts.get(history.vehicle, []):
        found.append((int(np.searchsorted(history.start_s, since_s)), part))
    return sorted(mark for mark in found if 0 < mark[0] < len(history))
