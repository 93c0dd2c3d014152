"""The tables of a dataset. A column has its unit in the metadata of its field, and its meaning in ``MEANINGS``."""

from __future__ import annotations

import pyarrow as pa

__all__ = ["FINDINGS", "FLIGHTS", "KINDS", "MEANINGS", "MONTH_UNKNOWN", "STEPS", "VERSION"]

VERSION = "3"
"""The version of the tables; it increases when a column is removed or changes its meaning."""

KINDS = ("steps", "findings", "flights")
"""The tables in the order of writing: a flight is complete when its row in ``flights`` exists."""

MONTH_UNKNOWN = "unknown"
"""The month in the name of the folder of logs without a start time. With Hive's name for null, pandas, pyarrow and Dask fail."""

MEANINGS: dict[str, str] = {}
"""The meanings of the columns. A name means the same in all tables."""

_TEXT, _REAL, _SMALL = pa.string(), pa.float64(), pa.float32()


def _schema(*columns: tuple[str, pa.DataType, str, str]) -> pa.Schema:
    """Columns by name, type, unit and meaning. A name that ends in ``!`` has no null values."""
    fields = []
    for name, kind, unit, meaning in columns:
        nullable, name = not name.endswith("!"), name.removesuffix("!")
        fields.append(pa.field(name, kind, nullable, {"unit": unit} if unit else None))
        assert MEANINGS.setdefault(name, meaning) == meaning
    return pa.schema(fields, {"flagred.fleet": VERSION})


FLIGHTS = _schema(
    ("log!", _TEXT, "", "the address of the log, without the access keys of the storage"),
    ("bytes!", pa.int64(), "B", "its size"),
    ("modified_utc", pa.timestamp("us", "UTC"), "", "when it was last modified"),
    ("identity!", _TEXT, "", "size and modification time: if they change, the log counts as changed"),
    ("etag", _TEXT, "", "the tag of the object, if the storage has one"),
    ("sha256", _TEXT, "", "the hash of its content, if contents are compared"),
    ("deleted!", pa.bool_(), "", "the log no longer existed when its source was last listed"),
    ("flight_id!", _TEXT, "", "identifies the flight in all tables"),
    ("status!", _TEXT, "", "assessed, unreadable, unavailable (the storage did not deliver it), crashed (it crashed its worker) or failed"),
    ("error", _TEXT, "", "why it was not assessed"),
    ("vehicle", _TEXT, "", "the vehicle: NAME, if the log is in a folder vehicle=NAME, else vehicle_id"),
    ("vehicle_id", _TEXT, "", "the identifier of the vehicle in the log"),
    ("vehicle_id_source", _TEXT, "", "the source of vehicle_id"),
    ("system_id", pa.int16(), "", "its MAVLink system id, which vehicles may share"),
    ("boot_count", pa.int64(), "", "the number of boots of its autopilot"),
    ("format", _TEXT, "", "the kind of log"),
    ("kind", _TEXT, "", "the kind of vehicle"),
    ("frame", _TEXT, "", "its frame"),
    ("firmware", _TEXT, "", "its firmware with version"),
    ("motors", pa.int16(), "", "the number of its motors"),
    ("start_utc", pa.timestamp("us", "UTC"), "", "when the log begins"),
    ("in_air_s", _REAL, "s", "time in the air"),
    ("assessed_s", _REAL, "s", "judged time: in the air, with a known risk"),
    ("filled_s", _REAL, "s", "time in the air with an interpolated risk, because no rule applied"),
    ("wind_m_s", _REAL, "m/s", "mean wind: measured, else estimated by the autopilot"),
    ("verdict", _TEXT, "", "GOOD, WARN, FAIL or NA"),
    ("reason", _TEXT, "", "why there is no verdict"),
    ("findings", pa.int32(), "", "the number of findings"),
    ("risk_mean_pct", _REAL, "%", "mean risk of judged time"),
    ("risk_max_pct", _REAL, "%", "highest risk of judged time"),
    ("risk_max_s", _REAL, "s", "when it was reached, on the clock of the log"),
    ("elevated_risk_max_pct", _REAL, "%", "highest elevated risk"),
    ("elevated_risk_max_s", _REAL, "s", "when it was reached, on the clock of the log"),
    ("saturated_share", _REAL, "1", "share of motor commands in the air within 0.5 % of a limit"),
    ("motor_commands", pa.list_(_REAL), "1", "mean command of each motor in the air, in the order of their numbers"),
    ("motor_margins", pa.list_(_REAL), "1", "mean margin of each motor in the air, in the order of their numbers"),
    ("weakest_motor", pa.int16(), "", "the number of the motor with the least mean margin in the air, from 1"),
    ("weakest_margin", _REAL, "1", "the mean margin of that motor"),
    ("messages", pa.int64(), "", "messages that were read"),
    ("skipped_bytes", pa.int64(), "B", "bytes that do not belong to a message"),
    ("bad_messages", pa.int64(), "", "messages that were rejected as damaged"),
    ("truncated", pa.bool_(), "", "the log ends inside a message"),
    ("damage", _TEXT, "", "the reason for the first skipped part"),
    ("profile!", _TEXT, "", "the profile"),
    ("settings!", _TEXT, "", "the hash of the profile, its rules and the step; a change means that the log is assessed again"),
    ("flagred!", _TEXT, "", "the version of flagred"),
)

FINDINGS = _schema(
    ("flight_id!", _TEXT, "", "identifies the flight in all tables"),
    ("vehicle", _TEXT, "", "the vehicle: NAME, if the log is in a folder vehicle=NAME, else vehicle_id"),
    ("severity!", _TEXT, "", "INFO, WARN or FAIL"),
    ("measure!", _TEXT, "", "risk, elevated_risk, or the subject of a notice"),
    ("from_s!", _REAL, "s", "when it began, on the clock of the log"),
    ("raised_s!", _REAL, "s", "when the level was raised"),
    ("failed_s", _REAL, "s", "when it became FAIL"),
    ("to_s!", _REAL, "s", "when it ended"),
    ("value_pct", _REAL, "%", "the worst value of the measure in that time"),
    ("threshold_pct", _REAL, "%", "the threshold that it crossed"),
    ("motor", pa.int16(), "", "the number of the motor at its limit, from 1"),
    ("side", _TEXT, "", "the limit it was nearest to: lower or upper"),
    ("margin_mean", _REAL, "1", "mean margin of that motor"),
    ("margin_min", _REAL, "1", "smallest margin of that motor"),
    ("rule", _TEXT, "", "the rule that raised the risk"),
    ("cause", _TEXT, "", "the input of that rule and its term"),
    ("code", _TEXT, "", "the code of the finding, such as fighting_gusts: docs/findings.md"),
    ("text!", _TEXT, "", "the finding in words"),
    ("advice", _TEXT, "", "what to do"),
)

STEPS = _schema(
    ("flight_id!", _TEXT, "", "identifies the flight in all tables"),
    ("t_s!", _REAL, "s", "time on the clock of the log"),
    ("risk_pct", _SMALL, "%", "risk"),
    ("elevated_risk_pct", _SMALL, "%", "elevated risk"),
    ("coverage", _SMALL, "1", "the largest firing strength of a rule, from 0 to 1"),
    ("filled", pa.bool_(), "", "whether the risk is interpolated, because no rule applied"),
    ("dominant_rule", pa.int16(), "", "the number of the rule with the largest firing strength, from 1; null if no rule fires"),
    ("margin", _SMALL, "1", "the margin of the motors"),
    ("spread", _SMALL, "1", "the spread of the motors"),
    ("judged!", pa.bool_(), "", "whether the step counts for the verdict"),
)
