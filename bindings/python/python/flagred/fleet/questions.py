"""Questions to a dataset: SQL for DuckDB over its Parquet files."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import lru_cache
from importlib.resources import files
from typing import Any

import pyarrow as pa

from .catalog import READERS
from .errors import DamagedError, FleetError
from .names import EMPTY, read_names, view
from .schema import FINDINGS, FLIGHTS, KINDS, STEPS
from .storage import Place, absolute, open_place, parquet
from .takeover import check

__all__ = ["QUESTIONS", "ask", "open_dataset"]


@lru_cache(maxsize=1)
def _parts() -> tuple[str, dict[str, str]]:
    """The common beginning of the questions, and each question by its name."""
    text = files(__package__).joinpath("questions.sql").read_text(encoding="utf-8")
    head, *parts = re.split(r"^-- name: ", text, flags=re.MULTILINE)
    return head, {name: sql for name, _, sql in (part.partition("\n") for part in parts)}


QUESTIONS: tuple[str, ...] = tuple(_parts()[1])
"""The names of the questions."""


def open_dataset(dataset: str, names: str | os.PathLike[str] | None = None, only: Mapping[str, str] | None = None) -> Any:
    """Opens a DuckDB connection with the views ``flights``, ``findings`` and ``steps`` of a dataset, local or on object
    storage.

    Parameters
    ----------
    dataset
        The dataset: a folder, or an address on object storage.
    names
        A CSV file with names, sites and pilots of vehicles: docs/fleet.md. ``vehicle`` is then the name, and ``flights``
        has the columns ``site`` and ``pilot``.
    only
        The vehicles to select, such as ``{"site": "North"}``: by ``vehicle``, ``site`` or ``pilot``.

    Raises
    ------
    FleetError
        There is no dataset, a file of it is damaged, or the names or the filter match none of its vehicles.
    """
    import duckdb  # Not needed, and not loaded into memory, for assessing only.

    uri = absolute(dataset)
    place = open_place(uri)
    check(place)
    connection = duckdb.connect()
    with _reading(place):
        _views(connection, place)
        connection.register("names", EMPTY if names is None else read_names(names))
        view(connection, names, only or {})
        connection.execute(_parts()[0])
        _require_findings(connection, place)
        # Errors of later questions can then name the damaged file.
        connection.execute("SET VARIABLE flagred_dataset = ?", [uri])
    return connection


def _views(connection: Any, place: Place) -> None:
    connection.execute("SET TimeZone = 'UTC'")
    for kind, schema in (("flights", FLIGHTS), ("findings", FINDINGS), ("steps", STEPS)):
        paths = [info.path for info in place.files(kind, ".parquet")]
        if not paths:
            if kind == "flights":
                raise FleetError(f"there are no flights in `{place.shown(place.root)}`", "make a dataset with `assess`")
            connection.register(f"stored_{kind}", schema.empty_table())
            continue
        with ThreadPoolExecutor(READERS) as readers:
            # Opens every file to find damaged ones, because DuckDB opens only the files that a question needs.
            list(readers.map(lambda path: _open(place, path), paths))
        if place.is_local:
            folder = place.file(kind).replace("'", "''")
            connection.execute(
                f"CREATE VIEW stored_{kind} AS FROM read_parquet('{folder}/*/*.parquet', hive_partitioning = true, hive_types = {{'month': VARCHAR}})"
            )
        else:
            import pyarrow.dataset

            month = pyarrow.dataset.partitioning(pa.schema([("month", pa.string())]), flavor="hive")
            of = pyarrow.dataset.dataset(
                paths, schema=pa.schema([*schema, ("month", pa.string())]), filesystem=place.fs, partitioning=month, format="parquet"
            )
            connection.register(f"stored_{kind}", of)


def _require_findings(connection: Any, place: Place) -> None:
    missing = "SELECT log FROM stored_flights WHERE findings > 0 AND flight_id NOT IN (SELECT flight_id FROM stored_findings) ORDER BY log LIMIT 1"
    if lost := connection.execute(missing).fetchone():
        raise DamagedError(f"the findings of `{lost[0]}` are missing in `{place.shown(place.root)}`", "run `assess` again: it reads the log again")


def _open(place: Place, path: str) -> None:
    """Raises :class:`DamagedError` if a file is truncated."""
    with parquet(place, path):
        pass


@contextmanager
def _reading(place: Place | None) -> Iterator[None]:
    """Converts errors of DuckDB to errors of a dataset, with the name of the damaged file."""
    import duckdb

    try:
        yield
    except (duckdb.Error, pa.ArrowException) as error:
        named = re.search(r"['\"]([^'\"]*\.parquet)['\"]", str(error))
        if named:
            raise DamagedError.of(named[1], error) from error
        # DuckDB does not name the file of a page that cannot be decoded.
        if place:
            for info in (info for kind in KINDS for info in place.files(kind, ".parquet")):
                with parquet(place, info.path) as file:
                    file.read()
        raise FleetError(f"the dataset cannot be read: {error}") from error


def ask(dataset: str | Any, question: str) -> pa.Table:
    """The answer to one of the ``QUESTIONS``.

    Parameters
    ----------
    dataset
        The dataset, or a connection returned by :func:`open_dataset`.
    question
        The name of the question.
    """
    if question not in _parts()[1]:
        raise FleetError(f"`{question}` is not a question", f"write one of {', '.join(QUESTIONS)}")
    connection = open_dataset(dataset) if isinstance(dataset, str) else dataset
    (dataset_of,) = connection.sql("SELECT getvariable('flagred_dataset')").fetchall()[0]
    with _reading(open_place(dataset_of) if dataset_of else None):
        answer: pa.Table = connection.sql(_parts()[1][question]).to_arrow_table()
    return answer
