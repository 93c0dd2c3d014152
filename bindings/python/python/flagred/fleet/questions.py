"""Questions to a dataset: SQL for DuckDB over its Parquet files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from importlib.resources import files
from typing import Any

import pyarrow as pa

from .errors import DamagedError, FleetError
from .schema import FINDINGS, FLIGHTS, STEPS
from .storage import Place, absolute, open_place

__all__ = ["QUESTIONS", "ask", "open_dataset"]


@lru_cache(maxsize=1)
def _parts() -> tuple[str, dict[str, str]]:
    """What comes before the questions, and each by its name."""
    text = files(__package__).joinpath("questions.sql").read_text(encoding="utf-8")
    head, *parts = re.split(r"^-- name: ", text, flags=re.MULTILINE)
    return head, {name: sql for name, _, sql in (part.partition("\n") for part in parts)}


QUESTIONS: tuple[str, ...] = tuple(_parts()[1])
"""The names of the questions."""


def open_dataset(dataset: str) -> Any:
    """A DuckDB connection with the views ``flights``, ``findings`` and ``steps`` of a dataset, here or on object storage.

    Raises
    ------
    FleetError
        There is no dataset, or a file of it is damaged.
    """
    import duckdb  # Who only assesses does without it and its memory.

    place = open_place(absolute(dataset))
    connection = duckdb.connect()
    with _reading():
        _views(connection, place)
    return connection


def _views(connection: Any, place: Place) -> None:
    connection.execute("SET TimeZone = 'UTC'")
    for kind, schema in (("flights", FLIGHTS), ("findings", FINDINGS), ("steps", STEPS)):
        paths = [info.path for info in place.files(kind, ".parquet")]
        if not paths:
            if kind == "flights":
                raise FleetError(f"there are no flights in `{place.shown(place.root)}`", "make a dataset with `assess`")
            connection.register(kind, schema.empty_table())
        elif place.is_local:
            folder = place.file(kind).replace("'", "''")
            connection.execute(
                f"CREATE VIEW {kind} AS FROM read_parquet('{folder}/*/*.parquet', hive_partitioning = true, hive_types = {{'month': VARCHAR}})"
            )
        else:
            import pyarrow.dataset

            month = pyarrow.dataset.partitioning(pa.schema([("month", pa.string())]), flavor="hive")
            of = pyarrow.dataset.dataset(
                paths, schema=pa.schema([*schema, ("month", pa.string())]), filesystem=place.fs, partitioning=month, format="parquet"
            )
            connection.register(kind, of)
    connection.execute(_parts()[0])


@contextmanager
def _reading() -> Iterator[None]:
    """Raises errors of DuckDB as those of a dataset, with the name of a file that is damaged."""
    import duckdb

    try:
        yield
    except (duckdb.Error, pa.ArrowException) as error:
        named = re.search(r"['\"]([^'\"]*\.parquet)['\"]", str(error))
        if named:
            raise DamagedError.of(named[1], error) from error
        raise FleetError(f"the dataset cannot be read: {error}") from error


def ask(dataset: str | Any, question: str) -> pa.Table:
    """The answer to one of the ``QUESTIONS``.

    Parameters
    ----------
    dataset
        The dataset, or a connection that :func:`open_dataset` gave.
    question
        The name of the question.
    """
    if question not in _parts()[1]:
        raise FleetError(f"there is no question `{question}`", f"questions are {', '.join(QUESTIONS)}")
    connection = open_dataset(dataset) if isinstance(dataset, str) else dataset
    with _reading():
        answer: pa.Table = connection.sql(_parts()[1][question]).to_arrow_table()
    return answer
