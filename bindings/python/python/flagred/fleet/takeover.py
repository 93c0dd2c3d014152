"""Only one run writes to a dataset at a time: the latest."""

from __future__ import annotations

import json
import uuid

from .. import __version__
from .errors import DamagedError, FleetError
from .storage import Place

__all__ = ["Superseded", "check", "still_ours", "take_over"]

RUN = "run.json"
"""The file of a dataset that names the run that writes to it."""


class Superseded(FleetError):
    """Another run writes to the dataset."""


def take_over(out: Place) -> str:
    """Starts a new run, which is then the only one that writes to the dataset, and returns its id. Workers of an earlier run,
    which may have lost their driver and continue, commit nothing more."""
    run = uuid.uuid4().hex
    out.write(out.file(RUN), json.dumps({"run": run, "flagred": __version__}).encode())
    return run


def check(out: Place) -> None:
    """Raises :class:`DamagedError` if the file that names the run exists and is damaged."""
    try:
        _run(out)
    except FileNotFoundError:
        pass


def _run(out: Place) -> str:
    content, _ = out.read(out.file(RUN))
    try:
        run: str = json.loads(content)["run"]
    except (ValueError, KeyError, TypeError) as error:
        help = "run `assess` for the dataset, which replaces the file, or delete the file while no run is active"
        raise DamagedError(f"`{out.shown(out.file(RUN))}` is damaged: {error}", help) from error
    return run


def still_ours(out: Place, run: str) -> None:
    """Raises :class:`Superseded` if a later run took over."""
    if _run(out) != run:
        raise Superseded(f"another run writes to `{out.shown(out.root)}`", "let one run end before the next begins")
