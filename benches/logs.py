#!/usr/bin/env python3
"""Log readers side by side: ours, pymavlink with a type filter, pyulog with a topic filter.

    benches/logs.py [LOG ...]              speed, on the same files in one run
    benches/logs.py --damage 20 [LOG ...]  rows recovered from that many damaged copies of each;
                                           pymavlink counts rows whose time is damaged, too
    benches/logs.py --large 500            speed and memory on a DataFlash log of so many MB

Without logs, the shipped flight is read. The peers are installed into a virtual environment
under target/ the first time. Times are seconds of CPU on one core.
"""

import argparse
import contextlib
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PEERS = ["pymavlink==2.4.50", "pyulog==1.3.0"]
SHIPPED = ROOT / "examples/flights/steady.BIN"
TARGET = {"pymavlink DataFlash": 100, "pymavlink tlog": 100, "pyulog": 10}
ATTITUDE = ["roll_deg", "pitch_deg", "roll_des_deg", "pitch_des_deg"]


def in_virtual_environment():
    home = ROOT / "target/bench-peers"
    python = home / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", home], check=True)
        subprocess.run([home / "bin/pip", "install", "--quiet", *PEERS], check=True)
    if Path(sys.prefix).resolve() != home.resolve():
        os.execv(python, [str(python), __file__, *sys.argv[1:]])


def reader():
    command = ["cargo", "build", "--quiet", "--release", "-p", "flagred-benches", "--bin", "read-log"]
    subprocess.run(command, cwd=ROOT, check=True)
    return ROOT / "target/release/read-log"


def ours(binary, log, runs, signals):
    done = subprocess.run([binary, log, str(runs), *signals], capture_output=True, text=True)
    if done.returncode:
        return None
    return json.loads(done.stdout)


def by_pymavlink(log, types):
    """The number of messages of each of these types."""
    from pymavlink import mavutil

    counts = dict.fromkeys(types, 0)
    connection = mavutil.mavlink_connection(str(log))
    while True:
        message = connection.recv_match(type=types)
        if message is None:
            return counts
        counts[message.get_type()] += 1


def by_pyulog(log, topics):
    from pyulog import ULog

    counts = dict.fromkeys(topics, 0)
    for dataset in ULog(str(log), topics, disable_str_exceptions=True).data_list:
        if dataset.multi_id == 0:
            counts[dataset.name] = len(dataset.data["timestamp"])
    return counts


def peer_of(log):
    """Name of the peer, its description, and the messages of commands and attitude."""
    start = Path(log).read_bytes()[:16]
    if start.startswith(b"ULog"):
        topics = ["actuator_motors", "actuator_outputs", "vehicle_attitude",
                  "vehicle_attitude_setpoint", "vehicle_status", "vehicle_land_detected"]
        return "pyulog", lambda path: by_pyulog(path, topics), topics[:2], topics[2]
    if start.startswith(b"\xa3\x95"):
        types = ["RCOU", "ATT", "EV", "PARM", "MSG", "MODE", "ARM"]
        return "pymavlink DataFlash", lambda path: by_pymavlink(path, types), types[:1], "ATT"
    types = ["SERVO_OUTPUT_RAW", "ATTITUDE", "NAV_CONTROLLER_OUTPUT", "HEARTBEAT", "PARAM_VALUE",
             "STATUSTEXT"]
    return "pymavlink tlog", lambda path: by_pymavlink(path, types), types[:1], "ATTITUDE"


def speed(binary, logs):
    print(f"{'log':<26}{'MB':>6}  {'peer':<20}{'peer s':>9}{'ours s':>10}{'ratio':>8}  rows")
    missed = False
    for log in logs:
        name, read, commands, attitude = peer_of(log)
        seconds = float("inf")
        for _ in range(2):
            start = time.process_time()
            counts = read(log)
            seconds = min(seconds, time.process_time() - start)
        own = ours(binary, log, 300, ATTITUDE)
        ratio = seconds / own["seconds"]
        missed |= ratio < TARGET[name]
        rows = f"{own['commands']}+{own['attitude']} of {max(counts[c] for c in commands)}+{counts[attitude]}"
        size = Path(log).stat().st_size / 1e6
        print(f"{Path(log).name:<26}{size:>6.1f}  {name:<20}{seconds:>9.3f}{own['seconds']:>10.5f}"
              f"{ratio:>7.0f}x  {rows} (target {TARGET[name]}x)")
    return missed


@contextlib.contextmanager
def silence():
    """Suppresses the messages of the peers about every damaged byte; the C part of pymavlink bypasses Python's streams."""
    sys.stdout.flush()
    kept = [os.dup(stream) for stream in (1, 2)]
    nothing = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nothing, stream)
    try:
        yield
    finally:
        sys.stdout.flush()
        for stream, old in zip((1, 2), kept):
            os.dup2(old, stream)
            os.close(old)
        os.close(nothing)


def damaged(log, seed):
    """A copy with twenty holes of up to 512 bytes after its first tenth, which contains definitions."""
    choose = random.Random(seed)
    data = bytearray(Path(log).read_bytes())
    for _ in range(20):
        at = choose.randrange(len(data) // 10, len(data))
        hole = choose.choice([1, 7, 64, 512])
        data[at:at + hole] = choose.randbytes(len(data[at:at + hole]))
    return data


def damage(binary, logs, copies):
    print(f"{'log':<26}{'copies':>7}  {'peer rows':>10}{'our rows':>10}  copies where the peer has more")
    missed = False
    for log in logs:
        name, read, commands, attitude = peer_of(log)
        total = [0, 0]
        behind = []
        for seed in range(copies):
            with tempfile.NamedTemporaryFile(suffix=Path(log).suffix) as copy:
                copy.write(damaged(log, seed))
                copy.flush()
                try:
                    with silence():
                        counts = read(copy.name)
                    theirs = max(counts[c] for c in commands) + counts[attitude]
                except Exception:  # the peer fails
                    theirs = 0
                own = ours(binary, copy.name, 1, ["roll_deg"])
                mine = own["commands"] + own["attitude"]
            total = [total[0] + theirs, total[1] + mine]
            if theirs > mine:
                behind.append(f"{seed}: {mine} of {theirs}")
        missed |= bool(behind)
        print(f"{Path(log).name:<26}{copies:>7}  {total[0]:>10}{total[1]:>10}  {'; '.join(behind) or '-'}")
    return missed


def large(binary, megabytes):
    with tempfile.NamedTemporaryFile(suffix=".bin") as log:
        flight = SHIPPED.read_bytes()
        left = megabytes * 1_000_000
        while left > 0:
            log.write(flight[:left])
            left -= len(flight)
        log.flush()
        missed = False
        for what, signals in [("motors alone", ["none"]), ("motors and attitude", ATTITUDE),
                              ("every signal", [])]:
            own = ours(binary, log.name, 5, signals)
            rate = own["bytes"] / own["seconds"] / 1e9
            memory = own["peak_kib"] * 1024 / 1e6
            print(f"{megabytes} MB, {what:<20} {rate:5.2f} GB/s  {memory:6.1f} MB of memory at most")
            missed |= what != "every signal" and (rate < 1 or memory > 64)
        return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("logs", nargs="*", default=[str(SHIPPED)])
    parser.add_argument("--damage", type=int, metavar="COPIES")
    parser.add_argument("--large", type=int, metavar="MB")
    arguments = parser.parse_args()
    in_virtual_environment()
    binary = reader()
    if arguments.large:
        missed = large(binary, arguments.large)
    elif arguments.damage:
        missed = damage(binary, arguments.logs, arguments.damage)
    else:
        missed = speed(binary, arguments.logs)
    sys.exit("a target is missed" if missed else 0)


if __name__ == "__main__":
    main()
