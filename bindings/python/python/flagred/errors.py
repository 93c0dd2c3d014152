"""Errors, and the findings that they carry."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

__all__ = ["DataError", "Diagnostic", "FlagredError", "LogError", "RuleSetError"]


class Diagnostic(NamedTuple):
    """A finding about a rule set: the problem, its position, and help.

    ``str()`` shows it with its source lines.
    """

    severity: Literal["error", "warning", "note"]
    """Its severity."""
    code: str
    """A stable identifier, such as ``unknown-term``."""
    message: str
    """The problem."""
    help: str | None
    """Advice on what to do."""
    file: str
    """The file, or a name in angle brackets for other sources."""
    line: int | None
    """The line, from 1; None without a text."""
    column: int | None
    """The character in the line, from 1; None without a text."""
    drawn: str = ""
    """The finding as text, with its source lines."""

    def __str__(self) -> str:
        return self.drawn

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={value!r}" for name, value in zip(self._fields[:-1], self))
        return f"Diagnostic({fields})"


class FlagredError(Exception):
    """The base of all errors of this package."""


class RuleSetError(FlagredError, ValueError):
    """A rule set that cannot be used. The message shows the findings with their source lines.

    Examples
    --------
    >>> import flagred
    >>> try:
    ...     flagred.loads("fuzzy: 1\\nname: fan\\n")
    ... except flagred.RuleSetError as error:
    ...     print([finding.code for finding in error.findings])
    ['missing-key', 'missing-key']
    """

    findings: list[Diagnostic]
    """All findings."""

    def __init__(self, text: str, findings: Sequence[Diagnostic] = ()) -> None:
        super().__init__(text)
        self.findings = list(findings)

    def __reduce__(self) -> tuple[type[RuleSetError], tuple[str, list[Diagnostic]]]:
        return type(self), (str(self), self.findings)


class LogError(FlagredError, ValueError):
    """A file that is not a flight log, or cannot be read."""


class DataError(FlagredError, ValueError):
    """Invalid values for a rule set or a monitor: an unknown name, a wrong number of values, text."""
