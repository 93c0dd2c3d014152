"""A fleet on object storage with failures: python benches/fleet/s3.py [--keys 1200]. Requires `pip install 'moto[server]'`.

Logs and dataset are on an S3 server process on loopback, which sometimes answers 503 and sometimes reads slowly: see
s3_server.py.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import socket
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pyarrow.parquet as pq

from common import flight_csv
from flagred import fleet

OPTIONS = "?endpoint_override=127.0.0.1:{port}&scheme=http&region=us-east-1&allow_bucket_creation=true"


def flights(dataset: str) -> dict[str, dict]:
    place = fleet.open_place(dataset)
    rows = []
    for info in place.files("flights", ".parquet"):
        with place.fs.open_input_file(info.path) as file:
            rows += pq.ParquetFile(file).read().to_pylist()
    assert len({row["log"] for row in rows}) == len(rows), "a log has two rows"
    return {row["log"]: row for row in rows}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--keys", type=int, default=1200)
    parser.add_argument("--port", type=int, default=28555)
    parser.add_argument("--folder", type=Path, default=Path("/tmp/flagred-s3"))
    given = parser.parse_args()
    shutil.rmtree(given.folder, ignore_errors=True)
    given.folder.mkdir(parents=True)
    os.environ |= {"AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test", "AWS_EC2_METADATA_DISABLED": "true"}
    server = subprocess.Popen([sys.executable, Path(__file__).with_name("s3_server.py"), str(given.port), given.folder])
    try:
        for _ in range(100):
            time.sleep(0.2)
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", given.port)) == 0:
                    break
        return check(given)
    finally:
        server.terminate()
        server.wait()
        shutil.rmtree(given.folder, ignore_errors=True)


def check(given: argparse.Namespace) -> int:
    options = OPTIONS.format(port=given.port)
    source, out = f"s3://fleet/logs{options}", f"s3://fleet/dataset{options}"
    place = fleet.open_place(source)
    place.fs.create_dir("fleet")
    texts = [flight_csv(seed, 20).encode() for seed in range(40)]
    special = {3: "busy-", 4: "busy-", given.keys // 2: "slow-", given.keys // 2 + 1: "slow-", given.keys - 2: "down-"}

    def put(number: int) -> None:
        place.write(f"{place.root}/vehicle={number % 7}/{special.get(number, '')}{number:06}.csv", texts[number % 40])

    with ThreadPoolExecutor(8) as writers:
        list(writers.map(put, range(given.keys)))
    place.write(f"{place.root}/noise.bin", b"no log" * 1000)

    def run() -> fleet.Assessed:
        begin_s = time.perf_counter()
        done = fleet.assess([source], out, recursive=True, workers=2)
        counts = json.loads((given.folder / "counts.json").read_text())
        print(f"{done}: {time.perf_counter() - begin_s:.1f} s; the server so far: {counts}", flush=True)
        return done

    done = run()
    assert (done.listed, done.assessed, done.not_assessed) == (given.keys + 1, given.keys + 1, 2), done
    rows = flights(out)
    by_status = {status: [row["log"] for row in rows.values() if row["status"] == status] for status in ("unreadable", "unavailable")}
    assert by_status["unreadable"] == ["s3://fleet/logs/noise.bin"], by_status
    down = f"s3://fleet/logs/vehicle={(given.keys - 2) % 7}/down-{given.keys - 2:06}.csv"
    assert by_status["unavailable"] == [down] and "endpoint" not in str(list(rows)), by_status
    tags = {row["etag"] for row in rows.values() if row["status"] == "assessed"}
    assert len(tags) == len(texts) and None not in tags, tags
    (given.folder / "recovered").touch()
    assert run().assessed == 1 and flights(out)[down]["status"] == "assessed"
    assert run().assessed == 0
    time.sleep(1.1)  # Modification times have a resolution of a second.
    place.write(f"{place.root}/vehicle=1/000001.csv", texts[9])
    place.delete(f"{place.root}/vehicle=2/000002.csv")
    assert run().assessed == 1
    rows = flights(out)
    assert [log for log, row in rows.items() if row["deleted"]] == ["s3://fleet/logs/vehicle=2/000002.csv"]
    same = next(row for log, row in rows.items() if log.endswith("000009.csv"))
    assert rows["s3://fleet/logs/vehicle=1/000001.csv"]["etag"] == same["etag"]
    print(f"{fleet.compact(out)} fewer files after joining")
    assert flights(out) == rows and run().assessed == 0
    assert fleet.ask(out, "verdicts").num_rows >= 1
    page = given.folder / "fleet.html"
    report = fleet.write_report(out, page, worst=2)
    assert not report.missing_reports and len(list((given.folder / "fleet.files/flights").iterdir())) == 2, report.missing_reports
    print(f"right: {len(rows)} rows; the report has {page.stat().st_size / 1e3:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
