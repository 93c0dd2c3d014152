"""One run writes to a dataset at a time: the latest."""

from __future__ import annotations

import json
import uuid

from .. import __version__
from .errors import FleetError
from .storage import Place

__all__ = ["Superseded", "still_ours", "take_over"]

RUN = "run.json"
"""The file of a dataset that tells which run writes to it."""


class Superseded(FleetError):
    """Another run writes to the dataset."""


def take_over(out: Place) -> str:
    """Makes a new run the one that writes to the dataset, and gives its id. Workers of a run before, which may have lost their
    driver and work on, commit nothing more."""
    run = uuid.uuid4().hex
    out.write(out.file(RUN), json.dumps({"run": run, "flagred": __version__}).encode())
    return run


def still_ours(out: Place, run: str) -> None:
    """Raises :class:`Superseded` where a later run took over."""
    content, _ = out.read(out.file(RUN))
    if json.loads(content)["run"] != run:
        raise Superseded(f"another run writes to `{out.shown(out.root)}`", "let one run end before the next begins")
