"""Flights: logs and their assessments."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import IO, TYPE_CHECKING, Any, Literal

import numpy as np

from . import _data
from ._core import AssessmentData, FlightData, Profile, Table
from ._data import Event, Finding, Gap, Geometry, Intervals, Motor, Parameter, Range, Report, Summary, Vehicle
from .errors import DataError
from ._picture import framed
from ._tables import names_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, DTypeLike, NDArray

__all__ = ["Assessment", "Flight", "Signal", "assess", "read_log"]


class Signal:
    """A signal of a flight: values over time.

    NumPy converts it to the array of its values; pyarrow, polars and others convert it to a table with the columns ``t_s``
    and its name.
    """

    __slots__ = ("_base", "_flight", "name", "rate_hz", "source", "unit")

    name: str
    """Its name, including the unit."""
    unit: str
    """Its unit; empty if it has none."""
    source: str
    """The message or field of the log that contains it."""
    rate_hz: float | None
    """The number of values per second, not counting pauses."""

    def __init__(self, flight: FlightData, name: str, unit: str, source: str, rate_hz: float | None, base: int) -> None:
        self._flight, self._base = flight, base
        self.name, self.unit, self.source, self.rate_hz = name, unit, source, rate_hz

    def _arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        arrays = self._flight._signal(self.name)
        assert arrays is not None
        return arrays

    @property
    def t_s(self) -> NDArray[np.float64]:
        """The times in seconds on the log's clock."""
        return self._arrays()[0]

    @property
    def values(self) -> NDArray[np.float64]:
        """The values; NaN is unknown."""
        return self._arrays()[1]

    @property
    def base(self) -> Table:
        """All signals that share its times, as a table."""
        table = self._flight._series_table(self._base)
        assert table is not None
        return table

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        values = self.values
        return values if dtype is None else values.astype(dtype, copy=False)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        t_s, values = self._arrays()
        unknown = np.isnan(values)
        known = None if not unknown.any() else ~unknown
        columns = [("t_s", {"unit": "s"}, t_s, None), (self.name, {"unit": self.unit}, values, known)]
        return Table._of_columns(columns).__arrow_c_stream__(requested_schema)

    def __iter__(self) -> Iterator[float]:
        return iter(self.values.tolist())

    def __len__(self) -> int:
        return len(self.t_s)

    def __repr__(self) -> str:
        rate = "" if self.rate_hz is None else f", {self.rate_hz:.1f} Hz"
        return f"Signal({self.name}: {len(self)} values{rate})"


class Signals(Mapping[str, Signal]):
    """The signals of a flight by their names."""

    def __init__(self, flight: FlightData) -> None:
        self._all = {signal[0]: Signal(flight, *signal) for signal in flight._signals()}

    def __getitem__(self, name: str) -> Signal:
        return self._all[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def table(self, names: Iterable[str], t_s: ArrayLike | None = None) -> dict[str, NDArray[np.float64]]:
        """Several signals at common times, as columns: ``pandas.DataFrame(flight.signals.table(["roll_deg", "altitude_m"]))``.

        Parameters
        ----------
        names
            The names of the signals.
        t_s
            The times in seconds, ascending; by default the times of the first signal.

        Returns
        -------
        dict
            ``t_s`` and a column for each signal: its latest value at or before each time; NaN before its first value and
            while it is unknown.
        """
        names = names_of(names)
        if not names:
            raise DataError("a table needs the name of at least one signal")
        for name in names:
            if name not in self._all:
                raise DataError(f"the flight has no signal `{name}`\n  help: its signals are {', '.join(self._all)}")
        times = self[names[0]].t_s if t_s is None else np.asarray(t_s, dtype=np.float64)
        columns = {"t_s": times}
        for name in names:
            at, values = self[name]._arrays()
            latest = np.searchsorted(at, times, side="right") - 1
            columns[name] = np.where(latest >= 0, values[np.maximum(latest, 0)], np.nan)
        return columns

    def __repr__(self) -> str:
        return f"Signals({', '.join(self._all)})"


class Flight(FlightData):
    """A flight, read from a log by :func:`read_log`.

    Times are in seconds on the log's own clock. A pickle of a flight contains the bytes of its log.
    """

    def __new__(cls, *args: Any, **kwargs: Any) -> Flight:
        raise TypeError("a flight is returned by `flagred.read_log`")

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled_flight, self._parts()

    @cached_property
    def _data(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self._json())
        return found

    @property
    def format(self) -> str:
        """The kind of log, such as ``PX4 ULog``."""
        format: str = self._data["format"]
        return format

    @cached_property
    def vehicle(self) -> Vehicle:
        """The vehicle, as far as the log describes it."""
        return Vehicle(**self._data["vehicle"])

    @cached_property
    def motors(self) -> list[Motor]:
        """The motors in order of their numbers, which is the order of the columns of the commands."""
        return [Motor(**motor) for motor in self._data["motors"]]

    @cached_property
    def geometry(self) -> Geometry | None:
        """The effect of each motor on roll, pitch and yaw; None if it is unknown."""
        data = self._data["geometry"]
        if data is None:
            return None
        return Geometry(**{**data, "factors": tuple(tuple(row) for row in data["factors"])})

    @cached_property
    def range(self) -> Range | None:
        """The range of the raw commands; None if it is unknown."""
        data = self._data["range"]
        return Range(**data) if data else None

    @cached_property
    def effective_range(self) -> Range:
        """The part of the range that is used in flight."""
        return Range(**self._data["effective_range"])

    @property
    def effective_range_doubt(self) -> str | None:
        """The reason why the whole range counts as the used part although the log contains limits."""
        doubt: str | None = self._data["effective_range_doubt"]
        return doubt

    @property
    def assumed(self) -> tuple[str, ...]:
        """Assumptions about motors, their commands and ranges that the log does not report."""
        return tuple(self._data["assumed"])

    @cached_property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters of the autopilot about motors and gains, by their names."""
        return {data["name"]: Parameter(**data) for data in self._data["parameters"]}

    @cached_property
    def modes(self) -> list[Event]:
        """The flight modes, with the time when each was entered."""
        return [Event(**event) for event in self._data["modes"]]

    @cached_property
    def messages(self) -> list[Event]:
        """Texts that the autopilot wrote into the log."""
        return [Event(**event) for event in self._data["messages"]]

    @cached_property
    def armed(self) -> Intervals | None:
        """The times at which the motors were armed; None if they are unknown."""
        return _data.intervals(self._data["armed"])

    @cached_property
    def in_air(self) -> Intervals | None:
        """The times at which the vehicle was in the air; None if they are unknown."""
        return _data.intervals(self._data["in_air"])

    @property
    def utc_at_zero_s(self) -> float | None:
        """UTC at time 0, in seconds since 1970; None if it is unknown."""
        utc: float | None = self._data["utc_at_zero_s"]
        return utc

    @property
    def boots_s(self) -> list[float]:
        """Times at which the autopilot booted again within the log."""
        boots: list[float] = self._data["boots_s"]
        return boots

    @property
    def header(self) -> dict[str, str]:
        """The header lines of a flight CSV."""
        return dict(self._data["header"])

    @cached_property
    def report(self) -> Report:
        """Amount of data read, and damage."""
        data = self._data["report"]
        return Report(**{**data, "left_out": _data.LeftOutCounts(**data["left_out"])})

    @cached_property
    def gaps(self) -> list[Gap]:
        """Information for an assessment that is missing from the log."""
        return [Gap(**gap) for gap in self._data["gaps"]]

    @property
    def t_s(self) -> NDArray[np.float64]:
        """The times of the motor commands."""
        return self._command_times()

    @property
    def raw_commands(self) -> NDArray[np.float64]:
        """The commands as logged, in the unit of ``range``: a row per sample, a column per motor; NaN is unknown."""
        return self._raw_commands()

    @property
    def commands(self) -> NDArray[np.float64]:
        """The commands on the effective range, from 0 to 1: a row per sample, a column per motor; NaN is unknown."""
        return self._effective_commands()

    @property
    def commands_table(self) -> Table:
        """``t_s`` and the command of each motor on the effective range, as a table."""
        return self._commands_table()

    @cached_property
    def signals(self) -> Signals:
        """All other signals by their names."""
        return Signals(self)

    def __repr__(self) -> str:
        air = "unknown" if self.in_air is None else f"{self.in_air.duration_s:.1f} s"
        return f"Flight({self.name}: {self.format}, {len(self.motors)} motors, in the air {air})"


class Assessment(AssessmentData):
    """The assessment of a flight, returned by :func:`assess`.

    A pickle of it contains the flight, the profile and the findings. The rest is computed again at its first use.
    """

    def __new__(cls, *args: Any, **kwargs: Any) -> Assessment:
        raise TypeError("an assessment is returned by `flagred.assess`")

    flight: Flight
    """The flight."""
    profile: Profile
    """The profile of the assessment."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled_assessment, (self.flight, self.profile, self._step_s(), self._json())

    @cached_property
    def _data(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self._json())
        return found

    @property
    def verdict(self) -> Literal["GOOD", "WARN", "FAIL", "NA"]:
        """The verdict of the flight; ``NA`` if there is none."""
        verdict: Literal["GOOD", "WARN", "FAIL", "NA"] = self._data["verdict"]["verdict"]
        return verdict

    @property
    def reason(self) -> str | None:
        """The reason why there is no verdict."""
        reason: str | None = self._data["verdict"].get("reason")
        return reason

    @property
    def help(self) -> str | None:
        """Advice for the pilot on how to get a verdict next time."""
        help: str | None = self._data["verdict"].get("help")
        return help

    @cached_property
    def findings(self) -> list[Finding]:
        """The findings, the most severe first."""
        return [_data.finding(dict(finding)) for finding in self._data["findings"]]

    @property
    def findings_left_out(self) -> int:
        """The number of findings that are not listed."""
        left_out: int = self._data["findings_left_out"]
        return left_out

    @cached_property
    def summary(self) -> Summary:
        """The summary of the flight."""
        return _data.summary(self._data["summary"])

    @property
    def assumed_inputs(self) -> dict[str, float]:
        """The inputs whose values were assumed because the log lacks their signals (``if_missing`` of the profile)."""
        return {assumed["input"]: assumed["value"] for assumed in self._data["assumed_inputs"]}

    @property
    def unknown_risks(self) -> dict[str, str]:
        """The risks of the profile that were unknown for some time in the air, each with the reason that applied longest."""
        return {unknown["output"]: unknown["reason"] for unknown in self._data["unknown_risks"]}

    @cached_property
    def steps(self) -> Table:
        """The risk over time, a row per step: ``t_s``, ``risk`` in % with the ends of its interval ``risk_low`` and
        ``risk_high``, ``elevated_risk`` in %, ``coverage``, ``filled``, ``dominant_rule``, ``margin``, ``spread``,
        ``judged``, ``input_NAME`` for each input of the profile, and ``other_risk_NAME`` in % for each of its other risks."""
        return self._steps()

    def moment(self, t_s: float) -> dict[str, Any]:
        """The state at a time of the flight, and the rules that fired.

        Parameters
        ----------
        t_s
            The time in seconds on the log's clock.

        Returns
        -------
        dict
            ``step`` is the latest step (None if no step is near, or if there are no steps), ``mode`` the flight mode,
            ``inputs`` the inputs with the degrees of their terms, ``rules`` the rules that fired, strongest first. The
            page and the JavaScript package return the same.

        Examples
        --------
        >>> import flagred
        >>> log = "t_s,motor1,motor2,motor3,motor4,in_air\\n"
        >>> log += "".join(f"{i / 50},0.45,0.5,0.55,0.5,1\\n" for i in range(1000))
        >>> moment = flagred.assess(log.encode(), "flagred-paper").moment(10)
        >>> moment["rules"][0]["rule"] == moment["step"]["dominant_rule"]
        True
        """
        found: dict[str, Any] = json.loads(self._moment(float(t_s)))
        return found

    def _repr_html_(self) -> str:
        return framed(self.html())

    def _unknown(self) -> Iterator[str]:
        """A line for each risk that was unknown for more than 5 % of the time in the air."""
        in_air_s = self.summary.in_air_s
        for unknown in self._data["unknown_risks"]:
            if unknown["unknown_s"] > 0.05 * in_air_s:
                share_pct = 100 * unknown["unknown_s"] / in_air_s
                yield f"  {unknown['output']} is unknown for {share_pct:.0f} % of the time: {unknown['reason']}"

    def __str__(self) -> str:
        lines = [f"{self.verdict} {self.flight.name}"]
        if self.reason is not None:
            lines.append(f"  no verdict: {self.reason}")
            lines.extend([f"  help: {self.help}"] if self.help else [])
        lines.extend(f"  {name} is assumed to be {value:g}" for name, value in self.assumed_inputs.items())
        lines.extend(self._unknown())
        lines.extend(f"  {finding.severity} {finding}" for finding in self.findings)
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"Assessment({self.verdict}: {len(self.findings)} findings, {self.flight.name})"


def read_log(
    log: str | os.PathLike[str] | bytes | IO[bytes],
    *,
    signals: Iterable[str] | None = None,
    range: tuple[int, int] | None = None,
) -> Flight:
    """Reads a flight log.

    Parameters
    ----------
    log
        The log: a path, its bytes, or a file that is open for reading. ArduPilot (.bin, .log), PX4 (.ulg), MAVLink
        (.tlog) or flight CSV, plain or gzipped; the format is detected from the content, not the name.
    signals
        The names of the signals to keep; by default all. Motor commands are always read.
    range
        The lowest and the highest pulse width of the motor outputs, in us, for a log that does not report it;
        :attr:`Flight.assumed` then mentions it.

    Raises
    ------
    LogError
        The file is not a flight log, reports its own range, or has commands above the given one. A damaged log is not an
        error: see :attr:`Flight.report`.
    ValueError
        The range is not possible for motor outputs.
    OSError
        The file cannot be read.

    Examples
    --------
    >>> import flagred
    >>> flight = flagred.read_log(b"t_s,motor1,motor2,motor3,motor4\\n0,0.4,0.4,0.5,0.5\\n1,0.4,0.4,0.5,0.6\\n")
    >>> flight.commands.shape
    (2, 4)
    """
    signals = None if signals is None else names_of(signals)
    if isinstance(log, (bytes, bytearray, memoryview)):
        return _flight(bytes(log), "<bytes>", signals, range)
    if isinstance(log, (str, os.PathLike)):
        return _flight(log, os.fspath(log), signals, range)
    if not hasattr(log, "read"):
        help_text = "give a path, the bytes of a log or an open file"
        if isinstance(log, (list, tuple)):
            help_text = "take one log at a time: `[flagred.assess(log) for log in logs]`"
        raise DataError(f"`{type(log).__name__}` is not a flight log\n  help: {help_text}")
    name = getattr(log, "name", "<file>")
    return _flight(bytes(log.read()), name if isinstance(name, str) else "<file>", signals, range)


def _flight(source: Any, name: str, signals: list[str] | None, range: tuple[int, int] | None) -> Flight:
    return FlightData.__new__(Flight, source, name, signals, range)


def _unpickled_flight(
    log: bytes, name: str, signals: list[str] | None, range: tuple[int, int] | None
) -> Flight:
    return FlightData.__new__(Flight, log, name, signals, range, True)


def _unpickled_assessment(flight: Flight, profile: Profile, step_s: float | None, json_text: str) -> Assessment:
    assessment: Assessment = AssessmentData.__new__(Assessment, flight, profile, step_s, json_text)
    assessment.flight, assessment.profile = flight, profile
    return assessment


def assess(
    log: Flight | str | os.PathLike[str] | bytes | IO[bytes],
    profile: Profile | str = "flagred",
    *,
    step_s: float | None = 0.1,
    range: tuple[int, int] | None = None,
) -> Assessment:
    """Assesses a flight: how close it was to losing control.

    Parameters
    ----------
    log
        A flight, or a log as for :func:`read_log`.
    profile
        The profile, its name, or its file.
    step_s
        The interval of the steps of the risk over time, in seconds; None for no steps.
    range
        The range of the motor outputs of a log that does not report it, as for :func:`read_log`.

    Raises
    ------
    LogError
        The file is not a flight log.
    RuleSetError
        The profile or its rule set has errors.

    Examples
    --------
    >>> import flagred
    >>> log = "t_s,motor1,motor2,motor3,motor4,in_air\\n"
    >>> log += "".join(f"{i / 50},0.45,0.5,0.55,0.5,1\\n" for i in range(1000))
    >>> flagred.assess(log.encode()).verdict
    'GOOD'
    """
    if not isinstance(profile, Profile):
        profile = Profile(profile)
    if isinstance(log, Flight) and range is not None:
        raise ValueError("`range` is given when a log is read: `read_log(log, range=...)`")
    return assessed(log if isinstance(log, Flight) else read_log(log, range=range), profile, step_s)


def assessed(flight: Flight, profile: Profile, step_s: float | None, *, with_intervals: bool = True) -> Assessment:
    """Like :func:`assess`; without intervals of the risk it takes half the time."""
    assessment: Assessment = AssessmentData.__new__(Assessment, flight, profile, step_s, with_intervals=with_intervals)
    assessment.flight, assessment.profile = flight, profile
    return assessment
