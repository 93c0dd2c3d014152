"""Errors that stop a job over a fleet."""

from __future__ import annotations

from ..errors import FlagredError

__all__ = ["DamagedError", "FleetError"]


class FleetError(FlagredError):
    """A job over a fleet cannot continue; ``help`` describes what to do."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help

    def __reduce__(self) -> tuple[type[FleetError], tuple[str, str | None]]:
        return type(self), (str(self), self.help)


class DamagedError(FleetError):
    """A file of a dataset is damaged or missing."""

    @classmethod
    def of(cls, file: str, error: object) -> DamagedError:
        """The error of a damaged file, by its path in readable form."""
        reason = str(error).partition("\n")[0]
        return cls(f"`{file}` is damaged: {reason}", _HELP)

    @classmethod
    def missing(cls, file: str) -> DamagedError:
        """The error of a missing file, by its path in readable form."""
        return cls(f"`{file}` is missing, but flights in the file of the same name in `flights` have rows in it", _HELP)


_HELP = "restore the file, or delete all files with its name in the dataset: `assess` then reads their logs again"
