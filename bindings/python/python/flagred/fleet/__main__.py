"""``python -m flagred.fleet``: the command line of fleets."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from .. import FlagredError
from .alerts import sentence
from .catalog import Counts
from .compaction import compact
from .errors import DamagedError, FleetError
from .report import write_report
from .run import Assessed, assess
from .storage import LOGS

__all__ = ["main"]

MAX_REPORTS = 1000


class Progress:
    """One line on a terminal: logs, bytes, rate, time left, failures; in a file, a line every half minute."""

    def __init__(self) -> None:
        self._counts = Counts(0, 0, 0, 0, 0)
        self._is_terminal = sys.stderr.isatty()
        self._began_s = self._said_s = time.monotonic()

    def planned(self, counts: Counts) -> None:
        self._counts = counts
        for error in counts.damaged:
            print(f"warning: {error}; the file is rewritten", file=sys.stderr)
        same = counts.listed - counts.new - counts.changed
        print(
            f"{counts.listed} logs, {_size(counts.listed_bytes)}: {counts.new} new, {counts.changed} changed, {same} done",
            file=sys.stderr,
        )
        if counts.passed_over:
            print(f"{counts.passed_over} skipped: the name is not UTF-8, or it is not a file", file=sys.stderr)

    def started(self, dashboard: str) -> None:
        print(f"dashboard: {dashboard}", file=sys.stderr)
        self._began_s = self._said_s = time.monotonic()

    def went_on(self, done: Assessed, workers: int | None) -> None:
        now_s = time.monotonic()
        if now_s - self._said_s < (0.2 if self._is_terminal else 30.0) and done.assessed < self._total:
            return
        self._said_s = now_s
        text = self._line(done, now_s - self._began_s) + (", no worker" if workers == 0 else "")
        print(f"\r\x1b[K{text}" if self._is_terminal else text, end="" if self._is_terminal else "\n", file=sys.stderr, flush=True)

    @property
    def _total(self) -> int:
        return self._counts.new + self._counts.changed

    def _line(self, done: Assessed, spent_s: float) -> str:
        rate = done.bytes / spent_s if spent_s > 0 else 0.0
        left = _time((self._counts.todo_bytes - done.bytes) / rate) if rate else "unknown"
        return (
            f"{done.assessed} of {self._total} logs, {_size(done.bytes)} of {_size(self._counts.todo_bytes)}, "
            f"{_size(rate)}/s, {left} left, {done.not_assessed} not assessed"
        )

    def end(self) -> None:
        """Ends the line."""
        if self._is_terminal:
            print(file=sys.stderr)


def _size(count: float) -> str:
    unit = "B"
    for next_unit in ("kB", "MB", "GB", "TB"):
        if count < 1000:
            break
        count, unit = count / 1000, next_unit
    return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"


def _time(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {seconds:02} s"


def parser() -> argparse.ArgumentParser:
    """The arguments of the command line."""
    parser = argparse.ArgumentParser(prog="python -m flagred.fleet", description="Assess fleets of flight logs.")
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("assess", help="assess the logs that are not in a dataset yet")
    one.add_argument("sources", nargs="+", metavar="SOURCE", help="a folder of logs, or s3://, gs://, az://")
    one.add_argument("--out", required=True, metavar="DATASET", help="the dataset: a folder, or s3://, gs://, az://")
    one.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://HOST:8786; by default all local cores")
    one.add_argument("--workers", type=int, metavar="N", help="processes on this machine (one per core)")
    one.add_argument("--profile", default="flagred", metavar="NAME|FILE", help="profile: a shipped one or a file (flagred)")
    one.add_argument("--step-s", type=float, default=1.0, metavar="S", help="time between steps, in seconds (1)")
    one.add_argument("--recursive", action="store_true", help="also read subfolders")
    one.add_argument("--include", action="append", metavar="PATTERN", help="only logs with such a name, such as '*.BIN' (default: every log format)")
    one.add_argument("--compare-content", action="store_true", help="compare logs by their content instead of size and time: reads every log")
    one.add_argument("--dry-run", action="store_true", help="count the logs to assess, and write nothing")
    one = commands.add_parser("report", help="write a page about a dataset")
    one.add_argument("dataset", metavar="DATASET")
    one.add_argument("-o", "--out", required=True, metavar="FILE", help="the page, such as fleet.html")
    one.add_argument("--alert", nargs="?", type=float, const=0.0, metavar="PCT", help="exit with 1 if the risk rose significantly, by more than this many percentage points (0)")
    one.add_argument("--alert-json", metavar="FILE", help="write changes and alerts as JSON; - for standard output")
    one.add_argument("--alert-command", metavar="COMMAND", help="a command to run for new alerts, with the JSON on its standard input")
    one.add_argument("--names", metavar="FILE", help="a CSV file of vehicles: vehicle (or serial, id), name, site, pilot")
    one.add_argument("--only", action="append", type=_filter, metavar="KEY=VALUE", help="select vehicles: vehicle=, site= or pilot=")
    one.add_argument("--parts", metavar="FILE", help="a CSV file of changed parts: vehicle, day, part")
    one.add_argument("--reports", type=_worst, default=0, metavar="worst:N", help="write the reports of the N worst flights")
    one = commands.add_parser("compact", help="join the small files of a dataset")
    one.add_argument("dataset", metavar="DATASET")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command. Returns its exit code: 0, 1 for an alert, 2 for a failure, 3 if a file of the dataset is damaged."""
    given = parser().parse_args(arguments)
    try:
        return COMMANDS[given.command](given)
    except (FlagredError, OSError) as error:
        print(f"\nerror: {error}", file=sys.stderr)
        if isinstance(error, FleetError) and error.help:
            print(f"  help: {error.help}", file=sys.stderr)
        return 3 if isinstance(error, DamagedError) else 2
    except KeyboardInterrupt:
        print("\nstopped: run the same command again to continue", file=sys.stderr)
        return 2


def _assess(given: argparse.Namespace) -> int:
    progress = Progress()
    done = assess(
        given.sources,
        given.out,
        profile=given.profile,
        step_s=given.step_s,
        recursive=given.recursive,
        include=given.include or LOGS,
        compare_content=given.compare_content,
        scheduler=given.scheduler,
        workers=given.workers,
        dry_run=given.dry_run,
        watcher=progress,
    )
    if done.assessed:
        progress.end()
    print(f"{done.assessed} logs read, {done.unchanged} of them unchanged, {done.not_assessed} not assessed")
    return 0


def _report(given: argparse.Namespace) -> int:
    only = dict(given.only or ())
    if len(only) < len(given.only or ()):
        raise FleetError("a filter is repeated", "give each of vehicle=, site= and pilot= at most once")
    report = write_report(
        given.dataset,
        given.out,
        least_pct=given.alert or 0.0,
        names=given.names,
        only=only,
        parts=given.parts,
        worst=given.reports,
        alert_command=given.alert_command,
    )
    for missing in report.missing_reports:
        print(f"warning: no report of {missing}", file=sys.stderr)
    if given.alert_json == "-":
        print(json.dumps(report.document, indent=2))
    else:
        for change in report.alerts:
            print(sentence(change))
        if given.alert_json:
            Path(given.alert_json).write_text(json.dumps(report.document, indent=2) + "\n", encoding="utf-8")
    wants_alert = given.alert is not None or given.alert_command is not None
    return 1 if wants_alert and report.alerts else 0


def _worst(text: str) -> int:
    kind, _, count = text.partition(":")
    if kind != "worst" or not count.isdigit() or not 1 <= int(count) <= MAX_REPORTS:
        raise argparse.ArgumentTypeError(f"`{text}` is not `worst:N` with N from 1 to {MAX_REPORTS}")
    return int(count)


def _filter(text: str) -> tuple[str, str]:
    key, sign, value = text.partition("=")
    if not sign:
        raise argparse.ArgumentTypeError(f"`{text}` is not KEY=VALUE, such as site=North")
    return key, value


def _compact(given: argparse.Namespace) -> int:
    print(f"{compact(given.dataset)} fewer files")
    return 0


COMMANDS = {"assess": _assess, "report": _report, "compact": _compact}


if __name__ == "__main__":
    sys.exit(main())
