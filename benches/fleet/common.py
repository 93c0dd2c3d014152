"""Functions shared by the scripts of this folder: logs, the rows of a dataset, a Dask cluster of processes on loopback."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pyarrow.parquet as pq

ROOT = Path(__file__).resolve().parents[2]
STEADY = ROOT / "examples/flights/steady.BIN"


def flight_csv(seed: int, seconds: int = 60) -> str:
    """A flight as CSV with random commands that sometimes saturate."""
    chance = random.Random(seed)
    head = f"# vehicle_id: v{seed % 17:02}\n# firmware: test {seed % 3}\n# utc_at_zero_s: {1_780_000_000 + seed * 43_210}\n"
    rows = []
    for i in range(25 * seconds):
        wild = 500 < i % 1000 < 500 + seed % 300
        commands = (min(1.0, max(0.0, chance.gauss(0.45, 0.4 if wild else 0.03))) for _ in range(4))
        rows.append(f"{i / 25}," + ",".join(f"{command:.3f}" for command in commands) + ",1\n")
    return head + "t_s,motor1,motor2,motor3,motor4,in_air\n" + "".join(rows)


def make_logs(folder: Path, count: int, own: int = 40) -> None:
    """Writes this many files in folders of vehicles: copies of the shipped flight and of some others; three of them are not
    logs."""
    shutil.rmtree(folder, ignore_errors=True)
    originals = folder.with_name(folder.name + "-originals")
    shutil.rmtree(originals, ignore_errors=True)
    originals.mkdir(parents=True)
    shutil.copy(STEADY, originals / "steady.BIN")
    for seed in range(own):
        (originals / f"{seed}.csv").write_text(flight_csv(seed))
    content = STEADY.read_bytes()
    (originals / "damaged.BIN").write_bytes(content[:1_000_000] + random.Random(1).randbytes(200_000) + content[1_200_000:])
    (originals / "noise.BIN").write_bytes(random.Random(2).randbytes(300_000))
    (originals / "empty.BIN").write_bytes(b"")
    for number in range(count):
        of = folder / f"vehicle={number % 20:02}"
        of.mkdir(parents=True, exist_ok=True)
        special = {count // 4: "damaged.BIN", count // 2: "noise.BIN", count * 3 // 4: "empty.BIN"}.get(number)
        name = special or ("steady.BIN" if number % 2 or own == 0 else f"{number // 2 % own}.csv")
        # Copies, because hard links to one file count once.
        shutil.copyfile(originals / name, of / f"{number:06}{Path(name).suffix}")


def rows(dataset: Path, kind: str) -> list[str]:
    """All rows of a table as text, sorted."""
    files = (dataset / kind).rglob("*.parquet")
    return sorted(str(row) for file in files for row in pq.ParquetFile(file).read().to_pylist())


def logs_of(dataset: Path) -> list[str]:
    """The log of each flight."""
    files = (dataset / "flights").rglob("*.parquet")
    return sorted(log for file in files for log in pq.ParquetFile(file).read(columns=["log"])["log"].to_pylist())


class Cluster:
    """A scheduler and workers as separate processes."""

    def __init__(self, workers: int, port: int, environment: dict[str, str] | None = None) -> None:
        self.workers, self.port = workers, port
        self.environment = {**os.environ, **(environment or {})}
        self.started: list[subprocess.Popen[bytes]] = []

    @property
    def address(self) -> str:
        return f"tcp://127.0.0.1:{self.port}"

    def _start(self, *arguments: str) -> None:
        command = [str(Path(sys.executable).with_name("dask")), *arguments]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.started.append(subprocess.Popen(command, env=self.environment, start_new_session=True, **quiet))

    def start(self) -> None:
        self._start("scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard")
        for _ in range(self.workers):
            self._start("worker", self.address, "--nthreads", "1", "--memory-limit", "1GiB", "--no-dashboard")
        from distributed import Client

        with Client(self.address, timeout=30, set_as_default=False) as client:
            client.wait_for_workers(self.workers, timeout=60)

    def scheduler_pid(self) -> int:
        return self.started[0].pid

    def worker_pids(self) -> list[int]:
        """The ids of the worker processes, without those of the supervisors that started them."""
        watchers = {process.pid for process in self.started[1:]}
        return [pid for pid, parent, command in processes() if parent in watchers and "spawn_main(" in command]

    def stop(self) -> None:
        for process in self.started:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
        self.started.clear()


def processes() -> list[tuple[int, int, str]]:
    """Number, parent and command line of all processes."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
                found.append((int(entry.name), parent, (entry / "cmdline").read_text().replace("\0", " ")))
            except (FileNotFoundError, ProcessLookupError):
                continue
    return found


def driver(arguments: list[str], shard_bytes: int | None = None) -> list[str]:
    """The command to run `flagred.fleet` as a process. With small shards there are more moments at which to kill it."""
    if shard_bytes is None:
        return [sys.executable, "-m", "flagred.fleet", *arguments]
    program = f"import sys, flagred.fleet.shards as shards; shards.MAX_BYTES = {shard_bytes}\n"
    program += "from flagred.fleet.__main__ import main; sys.exit(main(sys.argv[1:]))"
    return [sys.executable, "-c", program, *arguments]


@contextmanager
def timed(what: str):
    begin_s = time.perf_counter()
    yield
    print(f"{what}: {time.perf_counter() - begin_s:.2f} s", flush=True)
