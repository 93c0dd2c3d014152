"""Times the questions of the report: python benches/fleet/questions.py [--flights 1000000]"""

from __future__ import annotations

import argparse
import resource
import shutil
import sys
import time
from pathlib import Path

import synthetic
from flagred import fleet


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--flights", type=int, default=1_000_000)
    parser.add_argument("--vehicles", type=int, default=5000)
    parser.add_argument("--folder", type=Path, default=Path("/tmp/flagred-questions"))
    given = parser.parse_args()
    shutil.rmtree(given.folder, ignore_errors=True)
    out = given.folder / "out"
    synthetic.write(out, given.flights, given.vehicles, rising={"v00007": 1.0})
    size = sum(file.stat().st_size for file in out.rglob("*.parquet"))
    print(f"{given.flights} flights, {size / 1e6:.0f} MB of flights and findings")
    slowest_s = 0.0
    for question in fleet.QUESTIONS:
        begin_s = time.perf_counter()
        connection = fleet.open_dataset(str(out))
        connection.execute("SET threads = 2")
        rows = len(fleet.ask(connection, question))
        spent_s = time.perf_counter() - begin_s
        slowest_s = max(slowest_s, spent_s)
        print(f"{question}: {spent_s:.2f} s, {rows} rows")
    begin_s = time.perf_counter()
    found = fleet.write_report(str(out), given.folder / "fleet.html", least_pct=0.5).alerts
    print(f"report: {time.perf_counter() - begin_s:.2f} s, {(given.folder / 'fleet.html').stat().st_size / 1e3:.0f} kB")
    assert [change.vehicles for change in found] == [("v00007",)], found
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")
    shutil.rmtree(given.folder)
    return 0 if slowest_s < 5 else 1


if __name__ == "__main__":
    sys.exit(main())
