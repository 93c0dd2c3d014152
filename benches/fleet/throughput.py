"""The time and memory of a fleet: python benches/fleet/throughput.py [--logs 2000] [--names 100000]

Assesses this many logs with one and with two workers, and with plain processes that only read and assess; checks every
row; and measures the memory of the driver with that many names of logs.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pyarrow.parquet as pq

import flagred
from common import STEADY, logs_of, make_logs


def plain(paths: list[str]) -> int:
    """Reads and assesses like a fleet, and keeps nothing."""
    profile, done = flagred.Profile(), 0
    for path in paths:
        try:
            assessment = flagred.assess(path, profile, step_s=1.0)
        except flagred.LogError:
            continue
        done += len(assessment.findings) >= 0 and len(assessment.steps["t_s"]) >= 0 and assessment.summary is not None
    return done


def by_processes(paths: list[str], count: int) -> float:
    with multiprocessing.get_context("spawn").Pool(count) as pool:
        pool.map(plain, [paths[:1]] * count)  # Loads Python and flagred.
        begin_s = time.perf_counter()
        pool.map(plain, [paths[i : i + 29] for i in range(0, len(paths), 29)], chunksize=1)
        return time.perf_counter() - begin_s


def by_fleet(logs: Path, out: Path, workers: int) -> tuple[float, float]:
    """The total time in seconds, and the time after the workers were started."""
    shutil.rmtree(out, ignore_errors=True)
    program = (
        "import json, sys, time, flagred.fleet as fleet\n"
        "from flagred.fleet import engine\n"
        "class Watch:\n"
        "    def planned(self, counts): pass\n"
        "    def started(self, dashboard): self.began_s = time.perf_counter()\n"
        "    def went_on(self, done, workers): pass\n"
        "if __name__ == '__main__':\n"
        "    watch, begin_s = Watch(), time.perf_counter()\n"
        "    fleet.assess([sys.argv[1]], sys.argv[2], recursive=True, workers=int(sys.argv[3]), watcher=watch)\n"
        "    end_s = time.perf_counter()\n"
        "    print(json.dumps([end_s - begin_s, end_s - watch.began_s]))\n"
    )
    done = subprocess.run([sys.executable, "-c", program, logs, out, str(workers)], capture_output=True, text=True, check=True)
    whole_s, work_s = json.loads(done.stdout)
    return whole_s, work_s


def cpu_s() -> float:
    """CPU time of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def check(logs: Path, out: Path, count: int) -> None:
    """Checks that each log has one row, and that all links to one log have the same result."""
    found = logs_of(out)
    assert found == sorted(str(path) for path in logs.rglob("*") if path.is_file()) and len(found) == count
    files = sorted((out / "flights").rglob("*.parquet"))
    flights = [row for file in files for row in pq.ParquetFile(file).read().to_pylist()]
    print("rows by status:", dict(Counter(row["status"] for row in flights)))
    one = flagred.assess(STEADY, step_s=1.0)
    same = [row for row in flights if row["bytes"] == STEADY.stat().st_size and row["messages"] == one.flight.report.messages]
    answers = {(row["verdict"], row["risk_mean_pct"]) for row in same}
    assert answers == {(one.verdict, one.summary.risk_mean_pct)}, answers
    assert Counter(row["status"] for row in flights)["unreadable"] == 2
    assert sum((row["skipped_bytes"] or 0) > 100_000 for row in flights) == 1, "the damaged log"


def memory_of_names(names: int, out: Path) -> None:
    """The memory of a driver that lists this many logs, of which all but 29 are done, and assesses the rest."""
    program = (
        "import sys, resource, time, shutil, os\n"
        "from pathlib import Path\n"
        "import pyarrow as pa, pyarrow.parquet as pq\n"
        "import flagred, flagred.fleet as fleet\n"
        "from flagred.fleet.rows import told\n"
        "from flagred.fleet import storage, run\n"
        "names, out, real = int(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])\n"
        "listing = [fleet.Log(str(path), path.stat().st_size, path.stat().st_mtime_ns // 1000) for path in sorted(real.rglob('*.BIN'))[:29]]\n"
        "def simulated(self, recursive, include):\n"
        "    yield from listing\n"
        "    for i in range(names - len(listing)):\n"
        "        yield fleet.Log(f'{self.root}/vehicle={i % 1000:04}/2026/flight-{i:08}.BIN', 4_400_000, 1_790_000_000_000_000 + i)\n"
        "def made():\n"
        "    job = fleet.Job.of(str(out), flagred.Profile(), 1.0, False)\n"
        "    source = fleet.open_place(str(real))\n"
        "    part, number = [], 0\n"
        "    for i, log in enumerate(simulated(source, True, ())):\n"
        "        if i >= len(listing):\n"
        "            part.append(told(log.path, log, job) | {'status': 'assessed'})\n"
        "        if len(part) == 6500:\n"
        "            yield part; part = []\n"
        "    yield part\n"
        "if __name__ == '__main__':\n"
        "    if not out.exists():\n"
        "        for number, part in enumerate(made()):\n"
        "            folder = out / 'flights' / 'month=2026-09'; folder.mkdir(parents=True, exist_ok=True)\n"
        "            pq.write_table(pa.Table.from_pylist(part, fleet.FLIGHTS), folder / f'{number:05}.parquet')\n"
        "        sys.exit()\n"
        "    storage.Place.logs = simulated\n"
        "    begin_s = time.perf_counter()\n"
        "    done = fleet.assess([str(real)], str(out), recursive=True, workers=1)\n"
        "    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024\n"
        "    print(f'{names} names: {done.assessed} logs assessed, peak memory of the driver {peak:.0f} MB, {time.perf_counter() - begin_s:.1f} s')\n"
        "    assert done.assessed == len(listing)\n"
    )
    shutil.rmtree(out, ignore_errors=True)
    real = out.parent / "logs"
    for _ in range(2):
        subprocess.run([sys.executable, "-c", program, str(names), str(out), str(real)], check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=2000)
    parser.add_argument("--workers", type=int, nargs="*", default=[1, 2])
    parser.add_argument("--names", type=int, nargs="*", default=[100_000])
    parser.add_argument("--folder", type=Path, default=Path("/tmp/flagred-throughput"))
    given = parser.parse_args()
    logs, out = given.folder / "logs", given.folder / "out"
    make_logs(logs, given.logs)
    paths = sorted(str(path) for path in logs.rglob("*") if path.is_file())
    size = sum(Path(path).stat().st_size for path in paths)
    print(f"{len(paths)} logs, {size / 1e9:.1f} GB")
    spent = {}
    few = given.folder / "few"
    make_logs(few, 80)
    for workers in given.workers:
        started_s = cpu_s()
        by_fleet(few, out, workers)
        few_s = cpu_s() - started_s
        alone_s = by_processes(paths, workers)
        plain_s = cpu_s() - started_s - few_s
        whole_s, work_s = by_fleet(logs, out, workers)
        fleet_s = cpu_s() - started_s - few_s - plain_s
        spent[workers] = work_s
        check(logs, out, len(paths))
        # The cost of starting, and of a Python process, is subtracted with a run of few logs.
        overhead_ms = ((fleet_s - few_s) / (len(paths) - 80) - plain_s / len(paths)) * 1e3
        print(
            f"{workers} workers: {whole_s:.1f} s in all, {work_s:.1f} s without the start; plain processes {alone_s:.1f} s; CPU {fleet_s:.1f} s "
            f"and {plain_s:.1f} s, {overhead_ms:.2f} ms a log more; {size / work_s / 1e6:.0f} MB/s",
            flush=True,
        )
    if spent.keys() >= {1, 2}:
        print(f"two workers are {spent[1] / spent[2]:.2f} times as fast as one")
    for names in given.names:
        memory_of_names(names, given.folder / "names")
    shutil.rmtree(given.folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
