"""The differences between a dataset and the listed sources: missing, changed, duplicate and deleted logs.

The catalog is a database in a temporary file, so that a fleet of millions uses little memory. The dataset is
authoritative: every run creates its catalog anew from the ``flights`` files.
"""

from __future__ import annotations

import sqlite3
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import groupby, islice
from typing import Any

import pyarrow as pa

from .errors import DamagedError, FleetError
from .schema import KINDS, VERSION
from .storage import Log, Place, beside, parquet

__all__ = ["Catalog", "Counts"]

TABLES = """
CREATE TABLE listed(log TEXT PRIMARY KEY, source TEXT, path TEXT, bytes INT, modified_us INT, identity TEXT) WITHOUT ROWID;
CREATE TABLE file(id INTEGER PRIMARY KEY, name TEXT UNIQUE, stamp TEXT);
CREATE TABLE absent(file INT, kind TEXT);
CREATE TABLE flight(file INT, log TEXT, flight_id TEXT, identity TEXT, settings TEXT, status TEXT, deleted INT,
  modified_us INT, sha256 TEXT, findings INT, risk_max_pct REAL);
CREATE INDEX flight_log ON flight(log);
CREATE INDEX flight_file ON flight(file);
"""
COLUMNS = ["log", "flight_id", "identity", "settings", "status", "deleted", "modified_utc", "sha256", "findings", "risk_max_pct"]
READERS = 4


@dataclass(frozen=True)
class Counts:
    """The number of listed logs, and of logs to process."""

    listed: int
    listed_bytes: int
    new: int
    changed: int
    todo_bytes: int
    passed_over: int = 0
    """The number of names that match the patterns of logs but are not readable files."""
    damaged: tuple[DamagedError, ...] = ()
    """Damaged files of the dataset, which the run replaces."""


class Catalog:
    """The dataset and the listing, for comparison."""

    def __init__(self, settings: str, compare_content: bool = False) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="flagred-fleet-")
        self._db = sqlite3.connect(f"{self._folder.name}/catalog.sqlite", isolation_level=None)
        self._db.executescript("PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA cache_size=-16384;" + TABLES)
        self._torn: dict[str, DamagedError] = {}
        self._settings = {"settings": settings, "compare": compare_content}

    def __enter__(self) -> Catalog:
        return self

    def __exit__(self, *_: object) -> None:
        self._db.close()
        self._folder.cleanup()

    def take_in(self, source: Place, logs: Iterable[Log]) -> None:
        """Adds the logs of a source."""
        rows = ((source.shown(log.path), source.uri, log.path, log.bytes, log.modified_us, log.identity) for log in logs)
        with self._transaction():
            self._db.executemany("INSERT OR IGNORE INTO listed VALUES(?,?,?,?,?,?)", rows)

    def load(self, out: Place) -> None:
        """Adds the flights of the dataset; later calls add the changes since then."""
        now = {info.path: f"{info.size}-{info.mtime_ns}" for info in out.files("flights", ".parquet")}
        known = dict(self._db.execute("SELECT name, stamp FROM file"))
        changed = [path for path, stamp in now.items() if known.get(path) != stamp]
        with self._transaction(), ThreadPoolExecutor(READERS) as readers:
            for path in known.keys() - (now.keys() - set(changed)):
                self.forget(path)
            waiting = iter(changed)
            while some := list(islice(waiting, READERS)):
                for path, (rows, absent, torn) in zip(some, readers.map(lambda path: _rows(out, path), some)):
                    id = self._db.execute("INSERT INTO file(name, stamp) VALUES(?,?)", (path, now[path])).lastrowid
                    self._db.executemany(f"INSERT INTO flight VALUES({id}{',?' * len(COLUMNS)})", rows)
                    self._db.executemany(f"INSERT INTO absent VALUES({id},?)", [(kind,) for kind in absent])
                    if torn:
                        self._torn[path] = torn

    def damaged(self, out: Place) -> dict[str, DamagedError]:
        """The loaded files of ``flights`` whose steps or findings are damaged or missing.

        A flight with a risk has steps. Flights whose log has another row are ignored: they may be partly removed, since
        removal begins with steps and findings.
        """
        query = """
        SELECT DISTINCT n.name, a.kind FROM absent a JOIN file n ON n.id = a.file JOIN flight f USING(file)
        WHERE CASE a.kind WHEN 'findings' THEN f.findings > 0 ELSE f.risk_max_pct IS NOT NULL END
          AND (SELECT count(*) FROM flight g WHERE g.log = f.log) = 1
        """
        missing = {path: DamagedError.missing(out.shown(beside(out, path, kind))) for path, kind in self._db.execute(query)}
        return missing | self._torn

    def unlisted(self, path: str) -> list[str]:
        """The logs in a file of ``flights`` that are not listed."""
        query = "SELECT log FROM flight WHERE file = (SELECT id FROM file WHERE name = ?) AND log NOT IN (SELECT log FROM listed)"
        return [log for (log,) in self._db.execute(query, (path,))]

    def forget(self, path: str) -> None:
        """Removes the flights of a file from the catalog."""
        self._torn.pop(path, None)
        self._db.execute("DELETE FROM absent WHERE file = (SELECT id FROM file WHERE name = ?)", (path,))
        self._db.execute("DELETE FROM flight WHERE file = (SELECT id FROM file WHERE name = ?)", (path,))
        self._db.execute("DELETE FROM file WHERE name = ?", (path,))

    def counts(self) -> Counts:
        """Counts the listed logs and those to process."""
        listed, size = self._one("SELECT count(*), coalesce(sum(bytes), 0) FROM listed")
        todo = f"SELECT l.bytes, EXISTS(SELECT 1 FROM flight f WHERE f.log = l.log) AS known FROM listed l WHERE {TODO}"
        new, changed, todo_bytes = self._one(
            f"SELECT count(*) FILTER (WHERE NOT known), count(*) FILTER (WHERE known), coalesce(sum(bytes), 0) FROM ({todo})"
        )
        return Counts(listed, size, new, changed, todo_bytes)

    def todo(self) -> Iterator[tuple[str, Log]]:
        """The logs to assess with their sources, in order."""
        hash = "SELECT max(f.sha256) FROM flight f WHERE f.log = l.log AND f.settings = :settings AND f.status <> 'unavailable'"
        query = f"SELECT source, path, bytes, modified_us, ({hash}) FROM listed l WHERE {TODO} ORDER BY source, l.log"
        for source, path, size, modified_us, sha256 in self._db.execute(query, self._settings):
            yield source, Log(path, size, modified_us, sha256 if self._settings["compare"] else None)

    def doubled(self) -> Iterator[tuple[str, list[str]]]:
        """The flights that another row replaces, by the file to remove them from.

        A row with these settings takes precedence, then the row of the listed version of the log, then a row of a log that
        was available, then the row with the latest modification time.
        """
        query = """
        WITH doubled AS (SELECT log FROM flight GROUP BY log HAVING count(*) > 1),
        placed AS (
          SELECT f.file, f.flight_id, row_number() OVER (PARTITION BY f.log ORDER BY f.settings = :settings DESC,
            f.identity IS l.identity DESC, f.status = 'unavailable', f.modified_us DESC, n.name) AS place
          FROM flight f JOIN doubled USING(log) JOIN file n ON n.id = f.file LEFT JOIN listed l USING(log))
        SELECT name, flight_id FROM placed JOIN file ON file.id = placed.file WHERE place > 1 ORDER BY name
        """
        yield from self._by_file(query)

    def misjudged(self, wanted: Callable[[str], bool]) -> Iterator[tuple[str, list[str]]]:
        """The flights whose mark as deleted is wrong, by file, for logs that the listing would include."""
        self._db.create_function("wanted", 1, wanted, deterministic=True)
        query = """
        SELECT n.name, f.flight_id FROM flight f JOIN file n ON n.id = f.file LEFT JOIN listed l USING(log)
        WHERE f.deleted <> (l.log IS NULL) AND wanted(f.log) ORDER BY n.name
        """
        yield from self._by_file(query)

    def files(self) -> set[str]:
        """The ``flights`` files of the dataset."""
        return {name for (name,) in self._db.execute("SELECT name FROM file")}

    def _by_file(self, query: str) -> Iterator[tuple[str, list[str]]]:
        rows = self._db.execute(query, self._settings)
        for name, of in groupby(rows, lambda row: row[0]):
            yield name, [flight_id for _, flight_id in of]

    def _one(self, query: str) -> tuple[int, ...]:
        row: tuple[int, ...] = self._db.execute(query, self._settings).fetchone()
        return row

    def _transaction(self) -> _Transaction:
        return _Transaction(self._db)


TODO = """
(:compare OR NOT EXISTS(SELECT 1 FROM flight f WHERE f.log = l.log AND f.identity = l.identity AND f.settings = :settings
  AND f.status <> 'unavailable'))
"""


class _Transaction:
    def __init__(self, db: sqlite3.Connection) -> None:
        self._db = db

    def __enter__(self) -> None:
        self._db.execute("BEGIN")

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self._db.execute("COMMIT" if kind is None else "ROLLBACK")


def _rows(out: Place, path: str) -> tuple[list[tuple[Any, ...]], list[str], DamagedError | None]:
    """Returns the flights in a file as rows for the catalog, the tables that lack a file of this name, and the error if such a
    file is damaged. Compaction bounds the number of flights in a file."""
    with parquet(out, path) as file:
        version = (file.schema_arrow.metadata or {}).get(b"flagred.fleet", b"none").decode()
        if version != VERSION:
            help = f"this version of flagred reads and writes version {VERSION}: choose another dataset"
            raise FleetError(f"`{out.shown(path)}` has version {version} of the tables", help)
        table = file.read(columns=COLUMNS)
    modified = table["modified_utc"].cast(pa.int64())
    table = table.set_column(table.column_names.index("modified_utc"), "modified_utc", modified)
    rows = list(zip(*(table[name].to_pylist() for name in COLUMNS)))
    absent = []
    for kind in KINDS[:-1]:
        try:
            with parquet(out, beside(out, path, kind)):
                pass
        except FileNotFoundError:
            absent.append(kind)
        except DamagedError as error:
            return rows, absent, error
    return rows, absent, None
