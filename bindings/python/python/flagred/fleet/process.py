"""Processing of one shard: logs in, files of the dataset out. It does not depend on an engine."""

from __future__ import annotations

import hashlib
import re
import time
from dataclasses import dataclass

import pyarrow as pa
import pyarrow.parquet as pq

from ..errors import LogError
from .rows import Rows, add, told
from .schema import KINDS, MONTH_UNKNOWN
from .shards import Job, Shard
from .storage import Log, Place, open_place
from .takeover import still_ours

__all__ = ["Outcome", "process", "write"]

MIN_LOG_BYTES = 4096
"""The approximate minimum size of a log's rows in the dataset, in bytes."""
TRIES_S = (0.5, 2.0, 8.0)
"""The delays before an object is requested again, in seconds."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of a shard."""

    logs: int
    bytes: int
    not_assessed: int
    """Logs that could not be read or assessed; the row of each contains the reason."""
    unchanged: int
    """Logs with unchanged content."""


def process(shard: Shard, job: Job) -> Outcome:
    """Assesses the logs of a shard and writes their rows: steps, findings and last the flights, which commit them.

    A repeated call writes the same files.

    Raises
    ------
    Superseded
        Another run writes to the dataset now.
    OSError
        The dataset cannot be written.
    """
    source, out = open_place(shard.source), open_place(job.out)
    # Detects a full disk before the logs are read.
    out.require_space(MIN_LOG_BYTES * len(shard.logs))
    rows: dict[str | None, Rows] = {}
    unchanged = 0
    for log in shard.logs:
        unchanged += not _read(source, log, shard.crashed, job, rows)
    written = {month: of.tables() for month, of in rows.items()}
    for kind in KINDS:
        if kind == KINDS[-1]:
            still_ours(out, job.run)
        for month, tables in written.items():
            if kind in tables:
                write(out, out.file(kind, f"month={month or MONTH_UNKNOWN}", f"{shard.id}.parquet"), tables[kind])
    flights = [row for of in rows.values() for row in of.flights]
    not_assessed = sum(row["status"] != "assessed" for row in flights)
    return Outcome(len(shard.logs), shard.bytes, not_assessed, unchanged)


def _read(source: Place, log: Log, crashed: bool, job: Job, rows: dict[str | None, Rows]) -> bool:
    """Adds the rows of a log; false if it is unchanged or was deleted meanwhile."""
    row = told(source.shown(log.path), log, job)

    def failed(status: str, error: object) -> bool:
        rows.setdefault(None, Rows()).flights.append(row | {"status": status, "error": str(error)})
        return True

    if crashed:
        return failed("crashed", "the log crashes every worker that reads it")
    try:
        content: str | bytes = log.path
        if not source.is_local or job.compare_content:
            content, row["etag"] = _fetch(source, log.path)
        if job.compare_content and isinstance(content, bytes):
            row["sha256"] = hashlib.sha256(content).hexdigest()
            if row["sha256"] == log.sha256:
                return False
    except FileNotFoundError:
        return False
    except OSError as error:
        return failed("unavailable", error)
    try:
        add(rows, row, content, job)
    except FileNotFoundError:
        return False
    except LogError as error:
        # Removes the name of the log and the help, so that logs with the same error can be counted.
        return failed("unreadable", re.sub("^`[^`]*` ", "", str(error).partition("\n")[0]))
    except OSError as error:
        return failed("unavailable", error)
    except Exception as error:  # One log never ends the job: any error is recorded in its row.
        return failed("failed", f"{type(error).__name__}: {error}")
    return True


def _fetch(source: Place, path: str) -> tuple[bytes, str | None]:
    """The content and tag of a file; requests to a busy storage are repeated."""
    for wait_s in TRIES_S:
        try:
            return source.read(path)
        except FileNotFoundError:
            raise
        except OSError:
            time.sleep(wait_s)
    return source.read(path)


def write(out: Place, path: str, table: pa.Table) -> None:
    """Writes a table as a Parquet file."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
    out.write(path, sink.getvalue())
