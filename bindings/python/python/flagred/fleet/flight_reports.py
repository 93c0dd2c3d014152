"""Reports of the worst flights, from their logs."""

from __future__ import annotations

import hashlib
import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import FlagredError, Profile, assess
from .storage import open_place

__all__ = ["write_flight_reports"]


def write_flight_reports(files: Path, worst: Sequence[dict[str, Any]], dataset: str) -> tuple[dict[str, str], list[str]]:
    """Writes the report of each flight, unless it exists already. Returns their files by flight, and the reasons of missing
    reports.

    If a log was deleted, or a profile is a separate file, the flight has no report. Rows do not contain storage options:
    those of the dataset are used.
    """
    address, mark, options = dataset.partition("?")
    scheme = address.partition("://")[0] + "://"
    written: dict[str, str] = {}
    missing: list[str] = []
    for row in worst:
        # Other settings or another version require a new report.
        made_by = hashlib.sha256(f"{row['settings']} {row['flagred']}".encode()).hexdigest()[:8]
        name = f"flights/{row['flight_id']}-{made_by}.html"
        path = files / name
        if not path.exists():
            try:
                _write(path, row["log"], mark + options if row["log"].startswith(scheme) else "", Profile(row["profile"]))
            except (FlagredError, OSError, ValueError) as error:
                missing.append(f"{row['log']}: {str(error).partition(chr(10))[0]}")
                continue
        written[row["flight_id"]] = name
    return written, missing


class _Named(io.BytesIO):
    """The content of a log with its name, which the report shows."""

    name: str


def _write(path: Path, log: str, options: str, profile: Profile) -> None:
    source: str | _Named = log
    if not log.startswith("/"):
        place = open_place(log + options)
        source = _Named(place.read(place.root)[0])
        source.name = log
    page = assess(source, profile).html()
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.unfinished")
    unfinished.write_text(page, encoding="utf-8")
    os.replace(unfinished, path)
