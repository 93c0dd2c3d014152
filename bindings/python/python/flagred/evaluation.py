"""Validation of the risks of profiles: :func:`evaluate` and its results."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from functools import cached_property
from typing import IO, TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ._arrays import array
from ._core import EvaluationData, Profile, Table
from .errors import DataError
from ._flight import Flight, read_log
from ._picture import framed
from ._tables import column_names, column_of, same_length, table_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "Alarms",
    "AlarmsOfKind",
    "Areas",
    "Band",
    "Episode",
    "Estimator",
    "EvaluatedFlight",
    "Evaluation",
    "LeftOutFile",
    "NeedlessAlarms",
    "ProfileResult",
    "Span",
    "Upsets",
    "WarningTime",
    "Warnings",
    "evaluate",
]

_Interval = tuple[float, float]
_Log = Flight | str | os.PathLike[str] | bytes | IO[bytes]


class Areas(NamedTuple):
    """How well an estimator ranks critical cases. Intervals are 95 % intervals, computed by resampling whole flights."""

    auc: float | None
    """The area under the ROC curve."""
    auc_interval: _Interval | None
    pr_auc: float | None
    """The area under the precision-recall curve."""
    pr_auc_interval: _Interval | None
    no_auc: str | None
    """The reason why there is no area, such as ``no critical step``."""
    within_flight_auc: float | None
    """The mean area over the flights that have both critical and other cases."""
    within_flight_auc_interval: _Interval | None
    within_flight_flights: int
    """The number of those flights."""
    cases: int
    """The cases with a score."""
    critical: int
    """The critical cases among them."""
    unknown: int
    """The cases without a score."""


class Band(NamedTuple):
    """The cases with a risk in a band of 10 %, and the share of them that became critical."""

    from_pct: float
    to_pct: float
    cases: int
    critical: int
    critical_share: float | None
    risk_mean_pct: float | None


class Warnings(NamedTuple):
    """How well the warnings of a profile (levels WARN and FAIL) announce episodes of critical error."""

    flights: int
    hours: float
    """The assessed time."""
    episodes: int
    announced: int
    """Episodes that began while a warning was on."""
    lead_s_median: float | None
    groups: int
    """Groups of episodes at most 5 s apart."""
    groups_announced: int
    group_lead_s_median: float | None
    answered: int
    """Episodes that were not announced, but had a warning before their end."""
    answer_s_median: float | None
    warnings: int
    false_warnings: int
    share_of_time_on: float | None
    announced_share: float | None
    groups_announced_share: float | None
    false_per_hour: float | None


class NeedlessAlarms(NamedTuple):
    """The alarms of a profile in times without danger: in calm stretches, or in ordinary flights."""

    flights: int
    """The number of flights that contain times without danger and have a verdict."""
    not_assessed: int
    """The number of flights that contain times without danger, but whose verdict is NA."""
    hours: float
    """The total length of the times without danger."""
    verdicts: dict[str, int]
    """The numbers of flights with the verdicts GOOD, WARN and FAIL."""
    alarms: int
    """Periods of WARN or FAIL; a period that changes between them counts once."""
    alarms_per_hour: float | None
    alarms_per_hour_interval: _Interval | None
    fails: int
    fails_per_hour: float | None
    fails_per_hour_interval: _Interval | None
    share_of_time_on: float | None
    share_of_time_on_interval: _Interval | None


class Upsets(NamedTuple):
    """The upsets of flights, and the alarms of a profile about them."""

    assessed: int
    before: int
    """Upsets with an alarm in the 10 s before."""
    within_1_s: int
    """Upsets with an alarm raised within 1 s after."""
    never: int
    not_assessed: int
    """Upsets of flights without a verdict."""
    lead_s_median: float | None


class AlarmsOfKind(NamedTuple):
    """The alarms of a profile in flights of one kind."""

    calm_stretches: NeedlessAlarms
    upsets: Upsets


class Alarms(NamedTuple):
    """The alarms of a profile."""

    calm_stretches: NeedlessAlarms
    """Stretches of at least 20 s, later than 5 s after take-off, and at least 10 s away from any error over 5 degrees and any
    tilt over 45 degrees."""
    ordinary_flights: NeedlessAlarms
    """Flights without an upset, with an error over a second of at most 5 degrees and a tilt under 45 degrees."""
    upsets: Upsets
    upsets_by_fail: Upsets
    """The same upsets, where only FAIL counts as an alarm."""
    by_kind: dict[str, AlarmsOfKind]


class Estimator(NamedTuple):
    """A profile, or a predictor without rules, under evaluation."""

    name: str
    description: str
    areas: Areas
    """The areas over all cases."""
    quiet: Areas | None
    """The areas over steps without a critical error in the 5 s before; None for whole flights."""
    onset: Areas | None
    """The areas over steps without a critical error in the 10 s before; None for whole flights."""
    by_vehicle: dict[str, Areas]
    by_kind: dict[str, Areas]
    reliability: list[Band] | None
    """The reliability of a risk in %; None for other scores."""
    warnings: Warnings | None
    """The warnings of a profile on flights; None for predictors and for ``rows``."""
    warnings_by_kind: dict[str, Warnings]
    alarms: Alarms | None
    """The alarms of a profile on flights; None for predictors and for ``rows``."""


class Span(NamedTuple):
    """A time span on the log's clock, in seconds."""

    from_s: float
    to_s: float


class Episode(NamedTuple):
    """A time of critical error, and the warning that announced or followed it."""

    from_s: float
    to_s: float
    warned_s: float | None
    """The beginning of the warning; None without one."""
    lead_s: float | None
    """The time from the warning to the episode; negative if the warning came later."""


class WarningTime(NamedTuple):
    """A time at WARN or FAIL."""

    from_s: float
    to_s: float
    is_false: bool
    """Whether it does not belong to an episode."""


class ProfileResult(NamedTuple):
    """The results of a profile for a flight."""

    verdict: Literal["GOOD", "WARN", "FAIL", "NA"]
    alarms: list[Span]
    fails: list[Span]
    episodes: list[Episode]
    warnings: list[WarningTime]


class EvaluatedFlight(NamedTuple):
    """A flight, and the results of each profile."""

    file: str
    vehicle: str | None
    kind: str
    """The kind of flight, from its header."""
    judged_s: float
    in_air_s: float
    largest_error_deg: float | None
    """The largest attitude error over a second, in the air."""
    upsets_s: list[float]
    steps: int
    critical: int
    """The critical steps."""
    profiles: dict[str, ProfileResult]


class LeftOutFile(NamedTuple):
    """A file that is not among the flights, and the reason."""

    file: str
    reason: str


def _areas(data: dict[str, Any]) -> Areas:
    return Areas(**{name: _interval(data[name]) for name in Areas._fields})


def _interval(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _needless(data: dict[str, Any]) -> NeedlessAlarms:
    return NeedlessAlarms(**{name: _interval(value) for name, value in data.items()})


def _warnings(data: dict[str, Any]) -> Warnings:
    return Warnings(**{name: data[name] for name in Warnings._fields})


def _alarms(data: dict[str, Any]) -> Alarms:
    return Alarms(
        _needless(data["calm_stretches"]),
        _needless(data["ordinary_flights"]),
        Upsets(**data["upsets"]),
        Upsets(**data["upsets_by_fail"]),
        {
            of["kind"]: AlarmsOfKind(_needless(of["calm_stretches"]), Upsets(**of["upsets"]))
            for of in data["by_kind"]
        },
    )


def _estimator(data: dict[str, Any]) -> Estimator:
    warnings, alarms = data.get("warnings"), data.get("alarms")
    return Estimator(
        name=data["name"],
        description=data["description"],
        areas=_areas(data),
        quiet=_areas(data["quiet"]) if "quiet" in data else None,
        onset=_areas(data["onset"]) if "onset" in data else None,
        by_vehicle={of["vehicle"]: _areas(of) for of in data["by_vehicle"]},
        by_kind={of["kind"]: _areas(of) for of in data["by_kind"]},
        reliability=None if data["reliability"] is None else [Band(**band) for band in data["reliability"]],
        warnings=_warnings(warnings) if warnings else None,
        warnings_by_kind={of["kind"]: _warnings(of) for of in warnings["by_kind"]} if warnings else {},
        alarms=_alarms(alarms) if alarms else None,
    )


def _profile_result(data: dict[str, Any]) -> ProfileResult:
    return ProfileResult(
        data["verdict"],
        [Span(**span) for span in data["alarms"]],
        [Span(**span) for span in data["fails"]],
        [Episode(**episode) for episode in data["episodes"]],
        [WarningTime(of["from_s"], of["to_s"], of["false"]) for of in data["warnings"]],
    )


class Evaluation(EvaluationData):
    """The validation over many flights, returned by :func:`evaluate`. ``str()`` is the output of ``flagred validate``."""

    def __new__(cls, *args: Any, **kwargs: Any) -> Evaluation:
        raise TypeError("an evaluation is returned by `flagred.evaluate`")

    @cached_property
    def _data(self) -> dict[str, Any]:
        return self.to_dict()

    @property
    def cases(self) -> Literal["steps", "flights"]:
        """The kind of cases: ``steps``, half a second apart, or whole ``flights``."""
        cases: Literal["steps", "flights"] = self._data["cases"]
        return cases

    @property
    def horizon_s(self) -> float | None:
        """The prediction horizon; None for whole flights."""
        horizon_s: float | None = self._data["horizon_s"]
        return horizon_s

    @cached_property
    def estimators(self) -> dict[str, Estimator]:
        """The profiles, then the predictors without rules, by their names."""
        return {data["name"]: _estimator(data) for data in self._data["estimators"]}

    @cached_property
    def flights(self) -> list[EvaluatedFlight]:
        """The flights, in their order; empty for ``rows``."""
        return [
            EvaluatedFlight(
                **{**data, "profiles": {name: _profile_result(result) for name, result in data["profiles"].items()}}
            )
            for data in self._data["records"]
        ]

    @cached_property
    def left_out(self) -> list[LeftOutFile]:
        """The files that are not among the flights."""
        return [LeftOutFile(**file) for file in self._data["left_out_files"]]

    @property
    def notes(self) -> list[str]:
        """The estimators that ``rows`` do not support, and the reasons."""
        return self._notes()

    @cached_property
    def scores(self) -> Table:
        """The score of each estimator for each case, in a column with its name: a risk in %, or the value of a predictor. Also
        ``flight`` (its index), ``critical``, and for steps ``t_s``, ``quiet`` and ``onset``."""
        return self._scores()

    def roc(self, estimator: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The ROC curve of an estimator.

        Parameters
        ----------
        estimator
            Its name.

        Returns
        -------
        tuple of numpy.ndarray
            False and true positive rates; empty if there is no area.
        """
        names = list(self.estimators)
        if estimator not in names:
            there = ", ".join(f"`{name}`" for name in names)
            raise DataError(f"there is no estimator `{estimator}`\n  help: the estimators are {there}")
        return self._roc(names.index(estimator))

    def to_dict(self) -> dict[str, Any]:
        """The whole evaluation, as ``flagred validate --json`` prints it."""
        found: dict[str, Any] = json.loads(self.to_json())
        return found

    def _repr_html_(self) -> str:
        return framed(self.html())

    def __repr__(self) -> str:
        first = next(iter(self.estimators.values()))
        return f"Evaluation({len(self.estimators)} estimators on {first.areas.cases + first.areas.unknown} {self.cases})"


def evaluate(
    logs: _Log | Iterable[_Log] = (),
    profiles: Profile | str | Iterable[Profile | str] = (),
    *,
    rows: Any = None,
    horizon_s: float = 5.0,
    skip_bad_logs: bool = False,
    threads: int | None = None,
) -> Evaluation:
    """Compares the risks of profiles on many flights with predictors without rules. ``flagred validate`` does the same.

    Parameters
    ----------
    logs
        Flights, logs as for :func:`flagred.read_log`, and folders of logs. They must contain motors, attitude and times
        in the air. Other files in folders are skipped; see :attr:`Evaluation.left_out`.
    profiles
        Profiles to compare with the shipped ones, or their files.
    rows
        Instead of logs, a frame with a row for each flight, as written by ``flagred dataset``, with a column
        ``att_rmse_deg``.
    horizon_s
        The prediction horizon in seconds.
    skip_bad_logs
        Skip logs that cannot be used, and list the reasons in ``left_out``, instead of raising an error.
    threads
        The number of threads; by default the number of cores.

    Raises
    ------
    LogError
        A log cannot be used, or no log has a step.
    OSError
        A file cannot be read.
    RuleSetError
        A profile or its rule set has errors.
    DataError
        The rows lack a column or a number.

    Examples
    --------
    >>> import flagred
    >>> def log(gust_s):
    ...     text = "t_s,motor1,motor2,motor3,motor4,roll_des_deg,roll_deg,pitch_des_deg,pitch_deg,in_air\\n"
    ...     for i in range(1500):
    ...         since_s = i / 25 - gust_s
    ...         motors = "1,0,1,0.1" if 0 <= since_s < 8 else "0.5,0.5,0.52,0.52"
    ...         text += f"{i / 25},{motors},0,{20 if 3 <= since_s < 8 else 1},0,0,1\\n"
    ...     return text.encode()
    >>> evaluation = flagred.evaluate([log(gust_s=30), log(gust_s=100)])
    >>> evaluation
    Evaluation(11 estimators on 232 steps)
    >>> of = evaluation.estimators["flagred"]
    >>> round(of.areas.auc, 2), of.warnings.announced, round(of.warnings.lead_s_median, 1)
    (0.91, 1, 2.8)
    """
    if rows is not None:
        if not isinstance(logs, tuple) or logs:
            raise DataError("both logs and rows are given\n  help: evaluate them separately")
        rows = _rows(rows)
    asked = [profiles] if isinstance(profiles, (Profile, str, os.PathLike)) else list(profiles)
    loaded = [profile if isinstance(profile, Profile) else Profile(os.fspath(profile)) for profile in asked]
    evaluation: Evaluation = EvaluationData.__new__(
        Evaluation, _sources(logs), rows, loaded, horizon_s, skip_bad_logs, threads
    )
    return evaluation


def _sources(logs: Any) -> list[Any]:
    """Flights and paths; other values are read as logs."""
    one = isinstance(logs, (Flight, str, os.PathLike, bytes, bytearray, memoryview)) or hasattr(logs, "read")
    found = [logs] if one else list(logs)
    return [log if isinstance(log, (Flight, str, os.PathLike)) else read_log(log) for log in found]


def _rows(data: Any) -> dict[str, Any]:
    """The columns in the form that the native half requires: numbers or texts."""
    data = table_of(data)
    names = column_names(data)
    numbers: list[NDArray[np.float64] | None] = []
    texts: list[list[str]] = []
    for name in names:
        column = column_of(data, name)
        try:
            found = array(column)
        except DataError:
            numbers.append(None)
            texts.append(["" if value is None or value != value else str(value) for value in np.asarray(column).tolist()])
        else:
            numbers.append(found)
            texts.append(["" if value != value else f"{value:g}" for value in np.atleast_1d(found).tolist()])
    same_length([np.asarray(column) for column in texts])
    return {"names": names, "numbers": numbers, "texts": texts}
