"""A monitor that follows a flight sample by sample."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from . import _data
from ._core import MonitorData, Profile, Table, Update
from ._data import Finding, Summary

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class MonitorResult(NamedTuple):
    """The results of a flight that a monitor followed."""

    verdict: Literal["GOOD", "WARN", "FAIL", "NA"]
    reason: str | None
    """The reason why there is no verdict."""
    findings: list[Finding]
    summary: Summary
    steps: Table


class Monitor(MonitorData):
    """Follows a flight sample by sample, as on board.

    A monitor can be pickled at any time, also during a flight. It then continues the flight with the same results. Only
    the version of flagred that pickled a flight is sure to read it; another version refuses it with a :class:`DataError`.

    Parameters
    ----------
    profile
        The profile, its name, or its file.
    signals
        The names of the signals of each sample; a profile may require some.
    step_s
        The interval of the steps that :meth:`finish` returns, in seconds; None for no steps.

    Examples
    --------
    >>> import flagred
    >>> monitor = flagred.Monitor("flagred-paper")
    >>> for i in range(500):
    ...     t_s = i * 0.04
    ...     update = monitor.push(t_s, [0.4, 0.4, 0.41, 0.41] if t_s < 10 else [0.0, 1.0, 0.05, 1.0])
    >>> update.level
    'FAIL'
    """

    __slots__ = ("_made_of", "_names")

    def __new__(
        cls, profile: Profile | str = "flagred", *, signals: Sequence[str] = (), step_s: float | None = None
    ) -> Monitor:
        if not isinstance(profile, Profile):
            profile = Profile(profile)
        monitor: Monitor = super().__new__(cls, profile, list(signals), step_s)
        monitor._names, monitor._made_of = list(signals), (profile, step_s)
        return monitor

    _names: list[str]
    _made_of: tuple[Profile, float | None]

    def __reduce__(self) -> tuple[Any, ...]:
        profile, step_s = self._made_of
        return _unpickled_monitor, (profile, self._names, step_s, self._state())

    def push(
        self,
        t_s: float,
        commands: Sequence[float | None] | NDArray[np.float64],
        *,
        in_air: bool | None = None,
        signals: Mapping[str, float | None] | None = None,
    ) -> Update:
        """Processes a sample.

        Parameters
        ----------
        t_s
            Its time in seconds; times must not decrease.
        commands
            The command of each motor on its effective range, from 0 to 1. NaN and None are unknown. While a motor is
            unknown, so is the risk. Values from -0.5 to 1.5 are clamped to [0, 1]; others have another unit and raise a
            :class:`DataError`.
        in_air
            Whether the autopilot reports that the vehicle is in the air. None is unknown: then idle motors indicate that
            the vehicle is on the ground. Motors that idle for 3 s while it is True count as a fall, with a risk of 100 %.
        signals
            The values of the signals; missing ones are unknown.

        Returns
        -------
        Update
            The current risk and level.
        """
        known = signals or {}
        return self._push(t_s, commands, in_air, [known.get(name, float("nan")) for name in self._names])

    def ended(self) -> list[Finding]:
        """The findings that ended with the latest sample."""
        return [_data.finding(finding) for finding in json.loads(self._ended())]

    def finish(self) -> MonitorResult | None:
        """Ends the flight and returns its results; None without a sample. Later samples belong to a new flight."""
        finished = self._finish()
        if finished is None:
            return None
        data, steps = json.loads(finished[0]), finished[1]
        return MonitorResult(
            verdict=data["verdict"]["verdict"],
            reason=data["verdict"].get("reason"),
            findings=[_data.finding(finding) for finding in data["findings"]],
            summary=_data.summary(data["summary"]),
            steps=steps,
        )


def _unpickled_monitor(
    profile: Profile, signals: list[str], step_s: float | None, state: tuple[int, bytes] | None
) -> Monitor:
    monitor = Monitor(profile, signals=signals, step_s=step_s)
    if state is not None:
        monitor._restore(*state)
    return monitor
