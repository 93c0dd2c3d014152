"""What stops a job over a fleet."""

from __future__ import annotations

from .._errors import FlagredError

__all__ = ["FleetError"]


class FleetError(FlagredError):
    """A job over a fleet cannot go on; ``help`` says what to do."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help

    def __reduce__(self) -> tuple[type[FleetError], tuple[str, str | None]]:
        return type(self), (str(self), self.help)
