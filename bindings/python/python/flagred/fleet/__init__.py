"""Fleets: from a folder of logs, here or on object storage, to a dataset of Parquet files, on one machine or on a cluster.

``python -m flagred.fleet assess LOGS --out DATASET`` does the same as :func:`assess`. docs/fleet.md has the tables.
"""

import sys

try:
    from .compaction import compact
    from .errors import DamagedError, FleetError
    from .process import Outcome, process
    from .questions import QUESTIONS, ask, open_dataset
    from .report import rising, write_report
    from .run import Assessed, Plan, Watcher, assess, plan
    from .schema import FINDINGS, FLIGHTS, STEPS, VERSION
    from .shards import Job, Shard
    from .storage import Log, open_place
except ModuleNotFoundError as error:
    if (error.name or "").partition(".")[0] not in ("bokeh", "dask", "distributed", "duckdb", "pyarrow"):
        raise
    missing = f"flagred.fleet needs `{error.name}`: pip install 'flagred[fleet]'"
    if "-m" in sys.orig_argv and "flagred.fleet" in sys.orig_argv:
        print(f"error: {missing}", file=sys.stderr)
        sys.exit(2)
    raise ModuleNotFoundError(missing, name=error.name) from None

__all__ = [
    "FINDINGS",
    "FLIGHTS",
    "QUESTIONS",
    "STEPS",
    "VERSION",
    "Assessed",
    "DamagedError",
    "FleetError",
    "Job",
    "Log",
    "Outcome",
    "Plan",
    "Shard",
    "Watcher",
    "ask",
    "assess",
    "compact",
    "open_dataset",
    "open_place",
    "plan",
    "process",
    "rising",
    "write_report",
]
