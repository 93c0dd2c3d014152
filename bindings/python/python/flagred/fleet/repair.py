"""Repair of a dataset after a run: one row per log, marks of deleted logs, nothing left over from interruptions.

Each step can be interrupted anywhere: the next run completes it.
"""

from __future__ import annotations

from collections.abc import Callable

import pyarrow as pa
import pyarrow.compute as pc

from .catalog import Catalog
from .errors import DamagedError
from .process import write
from .schema import KINDS
from .storage import UNFINISHED, Place, beside, parquet

__all__ = ["redo", "repair"]


def redo(out: Place, catalog: Catalog, dry_run: bool) -> tuple[DamagedError, ...]:
    """Removes files with damaged or missing steps or findings from the dataset, so that their logs are read again. Returns
    their errors.

    Raises
    ------
    DamagedError
        Not all logs of such a file are listed, so that their rows would be lost.
    """
    damaged = catalog.damaged(out)
    for path, error in damaged.items():
        unlisted = catalog.unlisted(path)
        if unlisted:
            raise DamagedError(
                f"{error}; its log `{unlisted[0]}` is not in the given sources",
                "restore the file, or name the sources of all its logs, or delete all files with its name in the dataset (the rows of logs that no longer exist are then lost)",
            )
    for path in damaged:
        for kind in () if dry_run else KINDS[::-1]:
            out.delete(beside(out, path, kind))
        catalog.forget(path)
    return tuple(damaged.values())


def repair(out: Place, catalog: Catalog, wanted: Callable[[str], bool]) -> None:
    """Drops replaced rows, marks deleted logs, and deletes files that do not belong to a flight.

    Raises
    ------
    DamagedError
        A file of the dataset is damaged.
    """
    catalog.load(out)
    for error in catalog.damaged(out).values():
        raise error
    for path, flights in list(catalog.doubled()):
        drop(out, path, flights)
    catalog.load(out)
    for path, flights in list(catalog.misjudged(wanted)):
        mark(out, path, flights)
    sweep(out, catalog.files())


def drop(out: Place, flights_path: str, flights: list[str]) -> None:
    """Removes flights from a file, and from the files with the same name in the other tables; from ``flights`` last, so that
    the next run completes an interrupted removal. A file without remaining rows is deleted, from ``flights`` first."""
    gone = pa.array(flights)
    is_empty = read(out, flights_path).num_rows == len(flights)
    for kind in KINDS[::-1] if is_empty else KINDS:
        path = beside(out, flights_path, kind)
        if is_empty:
            out.delete(path)
            continue
        try:
            table = read(out, path)
        except FileNotFoundError:
            continue
        kept = table.filter(pc.invert(pc.is_in(table["flight_id"], gone)))
        if len(kept):
            write(out, path, kept)
        else:
            out.delete(path)


def mark(out: Place, path: str, flights: list[str]) -> None:
    """Toggles the deletion mark of some flights of a file."""
    table = read(out, path)
    deleted = pc.xor(table["deleted"], pc.is_in(table["flight_id"], pa.array(flights)))
    at = table.schema.get_field_index("deleted")
    write(out, path, table.set_column(at, table.schema.field(at), deleted))


def sweep(out: Place, flights: set[str]) -> None:
    """Deletes steps and findings without flights, and incomplete files."""
    for kind in KINDS[:-1]:
        for info in list(out.files(kind, ".parquet")):
            if beside(out, info.path, KINDS[-1], kind) not in flights:
                out.delete(info.path)
    if out.is_local:
        for kind in KINDS:
            for info in list(out.files(kind, UNFINISHED)):
                out.delete(info.path)


def read(out: Place, path: str) -> pa.Table:
    """Reads the table of a file."""
    with parquet(out, path) as file:
        return file.read()
