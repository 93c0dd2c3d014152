"""Fleets: from folders of logs, local or on object storage, to a dataset of Parquet files, on one machine or on a cluster.

``python -m flagred.fleet assess LOGS --out DATASET`` does the same as :func:`assess`. docs/fleet.md describes the tables.
"""

import sys

try:
    from .changes import Change, find_changes
    from .compaction import compact
    from .errors import DamagedError, FleetError
    from .process import Outcome, process
    from .questions import QUESTIONS, ask, open_dataset
    from .report import Report, write_report
    from .run import Assessed, Plan, Watcher, assess, plan
    from .schema import FINDINGS, FLIGHTS, STEPS, VERSION
    from .shards import Job, Shard
    from .storage import Log, open_place
except ModuleNotFoundError as _error:
    if (_error.name or "").partition(".")[0] not in ("bokeh", "dask", "distributed", "duckdb", "pyarrow"):
        raise
    _missing = f"flagred.fleet needs `{_error.name}`: pip install 'flagred[fleet]'"
    # While Python searches for the module of `-m`, `sys.argv[0]` is `-m` in place of the module's path.
    if sys.argv[:1] == ["-m"] and "flagred.fleet" in sys.orig_argv:
        print(f"error: {_missing}", file=sys.stderr)
        sys.exit(2)
    raise ModuleNotFoundError(_missing, name=_error.name) from None

__all__ = [
    "FINDINGS",
    "FLIGHTS",
    "QUESTIONS",
    "STEPS",
    "VERSION",
    "Assessed",
    "Change",
    "DamagedError",
    "FleetError",
    "Job",
    "Log",
    "Outcome",
    "Plan",
    "Report",
    "Shard",
    "Watcher",
    "ask",
    "assess",
    "compact",
    "find_changes",
    "open_dataset",
    "open_place",
    "plan",
    "process",
    "write_report",
]
