"""The contents of logs and assessments as plain data."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple


class Range(NamedTuple):
    """A range of commands, and its source."""

    low: float
    high: float
    unit: str
    """``us``, ``1`` (a fraction) or ``raw`` (counts of a bus)."""
    source: str


class Vehicle(NamedTuple):
    """The vehicle, as far as the log describes it."""

    kind: str
    """``multirotor``, ``plane``, ... or ``unknown vehicle``."""
    source: str
    frame: str | None
    motors: int | None
    """The number of motors, if the frame determines it."""
    firmware: str | None
    id: str | None
    """An identifier that distinguishes this vehicle from others."""
    id_source: str | None
    """The source of the id, such as ``sys_uuid``."""
    system_id: int | None
    """The MAVLink system id, which vehicles may share."""
    boot_count: int | None
    """The number of boots of the autopilot in its life."""


class Motor(NamedTuple):
    """A motor, and the output that drives it."""

    number: int
    """Its number in the autopilot, from 1."""
    output: str
    """The output, as the log names it."""
    source: str


class Geometry(NamedTuple):
    """The effect of each motor on roll, pitch and yaw."""

    factors: tuple[tuple[float, float, float], ...]
    """Roll, pitch and yaw of each motor; the largest of each axis is 1."""
    frame: str | None
    basis: str
    """``declared``, ``inferred`` or ``assumed``."""
    source: str
    doubt: str | None
    """The reason why the commands contradict this geometry; None if they do not."""


class Parameter(NamedTuple):
    """A parameter of the autopilot."""

    name: str
    value: float
    source: str


class Event(NamedTuple):
    """A message, or a flight mode and the time when it was entered."""

    t_s: float
    """The time in seconds on the log's clock."""
    what: str


class Interval(NamedTuple):
    """A time interval on the log's clock, in seconds."""

    start_s: float
    end_s: float
    ends_with_log: bool
    """Whether it was still open at the end of the log."""


class Intervals(NamedTuple):
    """Intervals in order of time, and the rule that determined them."""

    spans: tuple[Interval, ...]
    rule: str
    duration_s: float
    """The sum of their lengths."""


class LeftOutCounts(NamedTuple):
    """The numbers of items of a log that were dropped because they exceed a limit."""

    texts: int
    modes: int
    parameters: int
    changes: int
    messages: int


class Report(NamedTuple):
    """Amount of data read, and damage."""

    bytes: int
    messages: int
    skipped_bytes: int
    """Bytes that do not belong to any message."""
    bad_messages: int
    """Messages that were rejected as damaged."""
    truncated: bool
    """Whether the log ends inside a message."""
    reason: str | None
    """The first reason why data was skipped."""
    left_out: LeftOutCounts

    @property
    def is_clean(self) -> bool:
        """Whether nothing was skipped, rejected or cut off."""
        return self.skipped_bytes == 0 and self.bad_messages == 0 and not self.truncated


class Gap(NamedTuple):
    """Information that is missing from a log, and advice for the pilot."""

    reason: str
    help: str | None


class MotorFinding(NamedTuple):
    """The motor that is the cause: near a limit, or out of balance."""

    number: int
    """Its number, from 1."""
    or_number: int | None
    """Another motor that may be the cause, if the commands do not show which."""
    side: str
    """The nearest limit: ``lower`` or ``upper``. For a motor out of balance, ``lower`` is below its share."""
    margin_mean: float
    margin_min: float


class Cause(NamedTuple):
    """The cause of a risk: an input with its term and value, and the rule that reads it."""

    input: str
    term: str
    value: float
    rule: int
    """The rule number, from 1."""


class Finding(NamedTuple):
    """A period at or above a level, with its cause; or a notice. ``str()`` is the text for a pilot."""

    severity: Literal["GOOD", "INFO", "WARN", "FAIL"]
    from_s: float
    raised_s: float
    """The time at which the level was raised."""
    failed_s: float | None
    """The time at which it became FAIL; None if it did not."""
    to_s: float
    measure: str
    """``risk``, ``elevated_risk``, or the measure of a notice."""
    threshold_pct: float
    value_pct: float
    """The worst value of the measure in this period."""
    risk_low: float | None
    """The lower end of the interval of the highest risk in %; None if it is unknown or not computed."""
    risk_high: float | None
    """The upper end of that interval in %."""
    motor: MotorFinding | None
    cause: Cause | None
    risk_output: str | None
    """The output that is the risk, if it is not the first risk of the profile."""
    output: str | None
    """The output of the motor, as the log names it."""
    code: str
    """The kind of finding: a stable identifier for programs, such as ``fighting_gusts``."""
    text: str
    """What happened, and what it means."""
    advice: str
    """Advice on what to do."""

    def __str__(self) -> str:
        return f"{self.from_s:.1f} to {self.to_s:.1f} s: {self.text} {self.advice}"


class Peak(NamedTuple):
    """The largest value of a quantity, and the time at which it was first reached."""

    t_s: float
    value_pct: float


class Summary(NamedTuple):
    """A summary of a flight. The risks are those of the assessed time."""

    in_air_s: float
    assessed_s: float
    """The time in the air with a known risk."""
    filled_s: float
    """The time in the air with a risk interpolated where no rule fires."""
    risk_mean_pct: float | None
    risk_max: Peak | None
    elevated_risk_max: Peak | None
    saturated_share: float | None
    """The share of motor commands in the air within 0.5 % of a limit."""


def intervals(data: dict[str, Any] | None) -> Intervals | None:
    if data is None:
        return None
    spans = tuple(Interval(**span) for span in data["spans"])
    return Intervals(spans, data["rule"], data["duration_s"])


def finding(data: dict[str, Any]) -> Finding:
    motor, cause = data.pop("motor"), data.pop("cause")
    return Finding(
        motor=MotorFinding(**motor) if motor else None,
        cause=Cause(**cause) if cause else None,
        risk_low=data.pop("risk_low", None),
        risk_high=data.pop("risk_high", None),
        risk_output=data.pop("risk_output", None),
        **data,
    )


def summary(data: dict[str, Any]) -> Summary:
    peaks = {name: Peak(**data[name]) if data[name] else None for name in ("risk_max", "elevated_risk_max")}
    return Summary(**{**data, **peaks})
