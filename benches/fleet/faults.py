"""Kills parts of a fleet's job at random moments: python benches/fleet/faults.py [--rounds 20] [--logs 400]

In turn, a worker, all workers, the scheduler and the driver are killed (SIGKILL) while logs are assessed on a cluster of
two workers. Then the command runs once more, at once: workers that lost their driver may still be active. The dataset
must have exactly one row per log, and the rows of an undisturbed run; otherwise the exit code is 1.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from common import Cluster, driver, logs_of, make_logs, rows

VICTIMS = ("worker", "all workers", "scheduler", "driver")


def errors(said: str) -> list[str]:
    """The errors in the output of a command."""
    return [line for line in said.splitlines() if line.startswith("error")]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--logs", type=int, default=400)
    parser.add_argument("--folder", type=Path, default=Path("/tmp/flagred-faults"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--port", type=int, default=28786)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    logs, out = given.folder / "logs", given.folder / "out"
    make_logs(logs, given.logs)
    cluster = Cluster(2, given.port)
    command = driver(["assess", str(logs), "--recursive", "--out", str(out), "--scheduler", cluster.address], 8 << 20)

    def run() -> subprocess.Popen[str]:
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    cluster.start()
    try:
        shutil.rmtree(out, ignore_errors=True)
        begin_s = time.perf_counter()
        undisturbed = run()
        said = undisturbed.communicate()
        assert undisturbed.returncode == 0, said
        length_s = time.perf_counter() - begin_s
        expected = {kind: rows(out, kind) for kind in ("flights", "findings", "steps")}
        assert len(expected["flights"]) == given.logs and all(expected.values())
        print(f"undisturbed: {length_s:.1f} s, " + ", ".join(f"{len(of)} {kind}" for kind, of in expected.items()), flush=True)
        wrong = 0
        for number in range(given.rounds):
            victim = VICTIMS[number % len(VICTIMS)]
            shutil.rmtree(out)
            process = run()
            moment_s = chance.uniform(0.8, length_s)
            time.sleep(moment_s)
            done = len(logs_of(out)) if out.exists() else 0
            killed = {
                "worker": lambda: [chance.choice(cluster.worker_pids())],
                "all workers": cluster.worker_pids,
                "scheduler": lambda: [cluster.scheduler_pid()],
                "driver": lambda: [process.pid],
            }[victim]()
            assert killed, "nothing to kill"
            for pid in killed:
                os.kill(pid, signal.SIGKILL)
            said = process.communicate(timeout=300)
            if victim == "scheduler":
                cluster.stop()
                cluster.start()
            again = run()
            said_again = again.communicate(timeout=300)
            # Otherwise the next run would see what a worker without a driver was still processing.
            found = {kind: rows(out, kind) for kind in expected}
            logs_found = logs_of(out)
            is_right = again.returncode == 0 and found == expected and len(set(logs_found)) == len(logs_found) == given.logs
            wrong += not is_right
            print(
                f"round {number + 1}: {victim} killed after {moment_s:.1f} s with {done} logs done; driver ended with "
                f"{process.returncode} {errors(said[1])}, the rerun with {again.returncode} ({said_again[0].strip()}): "
                + ("right" if is_right else f"WRONG {len(logs_found)} rows\n{said}\n{said_again}"),
                flush=True,
            )
        print(f"{given.rounds - wrong} of {given.rounds} rounds right")
        return 1 if wrong else 0
    finally:
        cluster.stop()
        shutil.rmtree(given.folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
