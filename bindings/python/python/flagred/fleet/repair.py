"""A dataset put right after a run: one row a log, marks of deleted logs, nothing left over from what was interrupted.

Each step can be interrupted anywhere: the next run sees what is left to do.
"""

from __future__ import annotations

from collections.abc import Callable

import pyarrow as pa
import pyarrow.compute as pc

from .catalog import Catalog
from .process import write
from .schema import KINDS
from .storage import UNFINISHED, Place, parquet

__all__ = ["repair"]


def repair(out: Place, catalog: Catalog, wanted: Callable[[str], bool]) -> None:
    """Drops rows that others replace, marks logs that are gone, and sweeps what belongs to no flight."""
    catalog.load(out)
    for path, flights in list(catalog.doubled()):
        drop(out, path, flights)
    catalog.load(out)
    for path, flights in list(catalog.misjudged(wanted)):
        mark(out, path, flights)
    sweep(out, catalog.files())


def drop(out: Place, flights_path: str, flights: list[str]) -> None:
    """Takes flights out of a file, and out of those of the same name in the other tables; out of ``flights`` last, so that what is
    interrupted is seen again. A file that is left without rows goes, then out of ``flights`` first."""
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
    """Turns the mark as deleted of some flights of a file."""
    table = read(out, path)
    deleted = pc.xor(table["deleted"], pc.is_in(table["flight_id"], pa.array(flights)))
    at = table.schema.get_field_index("deleted")
    write(out, path, table.set_column(at, table.schema.field(at), deleted))


def sweep(out: Place, flights: set[str]) -> None:
    """Deletes steps and findings that were written without their flights, and files that were not finished."""
    for kind in KINDS[:-1]:
        for info in list(out.files(kind, ".parquet")):
            if beside(out, info.path, KINDS[-1], kind) not in flights:
                out.delete(info.path)
    if out.is_local:
        for kind in KINDS:
            for info in list(out.files(kind, UNFINISHED)):
                out.delete(info.path)


def beside(out: Place, path: str, kind: str, of: str = KINDS[-1]) -> str:
    """The file of the same shard and month in another table."""
    return out.file(kind, path.removeprefix(out.file(of) + "/"))


def read(out: Place, path: str) -> pa.Table:
    """The table of a file."""
    with parquet(out, path) as file:
        return file.read()
