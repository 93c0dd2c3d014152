"""Fleets: every log has one row, after any interruption."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("distributed", reason="Dask is not installed: `pip install flagred[fleet]`")

import pyarrow as pa
import pyarrow.parquet as pq
from distributed.core import Status

import flagred
from flagred import fleet
from flagred.fleet import engine, run, takeover
from flagred.fleet.__main__ import main
from flagred.fleet.catalog import Catalog
from flagred.fleet.shards import largest, shards
from flagred.fleet.storage import absolute, matcher, open_place


def csv(number: int) -> str:
    head = f"# vehicle_id: v{number % 3}\n# utc_at_zero_s: {1_790_000_000 + number * 900_000}\n# firmware: test 1.{number % 2}\n"
    rows = (f"{i / 25},{0.4 + number / 100},0.4,0.41,0.41,1\n" for i in range(500))
    return head + "t_s,motor1,motor2,motor3,motor4,in_air\n" + "".join(rows)


@pytest.fixture
def logs(tmp_path: Path, steady: Path) -> Path:
    """Seven flight logs in two folders, and two files that are not logs."""
    folder = tmp_path / "logs"
    for number in range(6):
        file = folder / f"vehicle=v{number}" / f"{number}.csv"
        file.parent.mkdir(parents=True)
        file.write_text(csv(number))
    shutil.copy(steady, folder / "steady.BIN")
    (folder / "noise.bin").write_bytes(bytes(range(7, 200)) * 50)
    (folder / "empty.ulg").write_bytes(b"")
    (folder / "notes.txt").write_text("no log")
    return folder


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes shards in this process: most tests do not need a cluster."""

    def work(planned, done, told, scheduler, workers):
        for shard in planned.shards:
            done = run._sum(done, fleet.process(shard, planned.job))
        return done

    monkeypatch.setattr(run, "_work", work)
    monkeypatch.setattr(fleet.shards, "MAX_BYTES", 100_000)


def table(out: Path, kind: str) -> pa.Table:
    files = sorted((out / kind).rglob("*.parquet"))
    return pa.concat_tables(pq.ParquetFile(file).read() for file in files)


def flights(out: Path) -> dict[str, dict]:
    rows = table(out, "flights").to_pylist()
    assert len({row["log"] for row in rows}) == len(rows), "a log has two rows"
    return {Path(row["log"]).name: row for row in rows}


def content(out: Path) -> list[list]:
    """All rows of all tables, sorted."""
    return [sorted(map(str, table(out, kind).to_pylist())) for kind in ("flights", "steps")]


def test_a_folder_of_logs(logs, tmp_path, here):
    out = tmp_path / "out"
    done = fleet.assess([str(logs)], str(out), recursive=True)
    assert (done.listed, done.assessed, done.not_assessed) == (9, 9, 2)
    rows = flights(out)
    assert len(rows) == 9
    assert {name for name, row in rows.items() if row["status"] == "unreadable"} == {"noise.bin", "empty.ulg"}
    assert rows["noise.bin"]["error"] == "is an unknown binary file, not a flight log"
    assert rows["noise.bin"]["verdict"] is None
    one = flagred.assess(logs / "steady.BIN", step_s=1.0)
    row = rows["steady.BIN"]
    assert (row["verdict"], row["risk_mean_pct"], row["frame"]) == (one.verdict, one.summary.risk_mean_pct, "QUAD/X")
    assert row["bytes"] == (logs / "steady.BIN").stat().st_size and row["boot_count"] == 1
    assert (rows["4.csv"]["vehicle"], rows["4.csv"]["vehicle_id"]) == ("v4", "v1")
    assert rows["4.csv"]["start_utc"].timestamp() == 1_793_600_000
    steps = table(out, "steps").filter(pa.compute.field("flight_id") == row["flight_id"])
    assert len(steps) == len(one.steps["t_s"])
    assert steps["risk_pct"].to_pylist() == pa.table(one.steps)["risk"].cast(pa.float32()).to_pylist()


def test_months_and_units(logs, tmp_path, here):
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out), recursive=True)
    months = {path.parent.name for path in (out / "flights").rglob("*.parquet")}
    assert {"month=2026-09", "month=2026-10", "month=unknown"} < months
    file = next((out / "flights").rglob("*.parquet"))
    schema = pq.read_schema(file)
    assert schema.metadata[b"flagred.fleet"] == fleet.VERSION.encode()
    assert schema.field("in_air_s").metadata[b"unit"] == b"s"


@pytest.mark.parametrize("kind", ["flights", "steps"])
def test_five_libraries_read_a_dataset_also_of_logs_without_a_start_time(kind, logs, tmp_path, here):
    pandas, polars, duckdb = (pytest.importorskip(name) for name in ("pandas", "polars", "duckdb"))
    frame = pytest.importorskip("dask.dataframe")
    out = tmp_path / "out"
    (logs / "undated.csv").write_text("".join(line for line in csv(7).splitlines(True) if "utc_at_zero_s" not in line))
    fleet.assess([str(logs)], str(out), recursive=True)
    folder, rows = str(out / kind), len(table(out, kind))
    assert (out / kind / "month=unknown").exists()
    of_dask = frame.read_parquet(folder).compute()
    tables = {
        "pandas": pandas.read_parquet(folder)["month"].astype(str).tolist(),
        "pyarrow": pq.read_table(folder)["month"].cast(pa.string()).to_pylist(),
        "dask": of_dask["month"].astype(str).tolist(),
        "polars": polars.read_parquet(folder)["month"].cast(polars.String).to_list(),
        "duckdb": [month for (month,) in duckdb.sql(f"SELECT month FROM read_parquet('{folder}/*/*.parquet')").fetchall()],
    }
    for library, months in tables.items():
        assert len(months) == rows and "unknown" in months and "2026-09" in months, library
        assert sorted(months) == sorted(tables["pyarrow"]), library
    if kind == "flights":
        weakest = pandas.read_parquet(folder).set_index("vehicle")["weakest_motor"]
        assert weakest["v0"] == of_dask.set_index("vehicle")["weakest_motor"]["v0"] == 1


def test_motors_have_their_mean_margin(logs, tmp_path, here):
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out), recursive=True)
    row = flights(out)["4.csv"]
    assert row["motor_commands"] == pytest.approx([0.44, 0.4, 0.41, 0.41])
    assert row["motor_margins"] == pytest.approx([0.44, 0.4, 0.41, 0.41])
    assert row["weakest_motor"] == 2 and row["weakest_margin"] == pytest.approx(0.4)
    assert flights(out)["noise.bin"]["motor_margins"] is None


def test_only_missing_or_changed_logs_are_assessed(logs, tmp_path, here):
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out))
    assert len(flights(out)) == 3
    assert fleet.assess([str(logs)], str(out), recursive=True).assessed == 6
    before = flights(out)
    assert fleet.assess([str(logs)], str(out), recursive=True).assessed == 0
    assert flights(out) == before
    changed = logs / "vehicle=v1" / "1.csv"
    changed.write_text(csv(40))
    assert fleet.assess([str(logs)], str(out), recursive=True).assessed == 1
    after = flights(out)
    assert after["1.csv"] != before["1.csv"]
    assert {name: row for name, row in after.items() if name != "1.csv"} == {
        name: row for name, row in before.items() if name != "1.csv"
    }
    assert set(table(out, "steps")["flight_id"].to_pylist()) == {
        row["flight_id"] for row in after.values() if row["status"] == "assessed"
    }


def test_a_log_of_the_same_content(logs, tmp_path, here):
    out = tmp_path / "out"
    assert fleet.assess([str(logs)], str(out), compare_content=True).unchanged == 0
    os.utime(logs / "steady.BIN", (0, 0))
    done = fleet.assess([str(logs)], str(out), compare_content=True)
    assert (done.assessed, done.unchanged) == (3, 3)
    (logs / "steady.BIN").write_bytes((logs / "steady.BIN").read_bytes()[:-1000])
    os.utime(logs / "steady.BIN", (0, 0))
    assert fleet.assess([str(logs)], str(out), compare_content=True).unchanged == 2
    assert len(flights(out)) == 3


def test_other_settings_assess_logs_again(logs, tmp_path, here):
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out))
    assert fleet.assess([str(logs)], str(out), profile="flagred-paper").assessed == 3
    assert {row["profile"] for row in flights(out).values()} == {"flagred-paper"}
    with pytest.raises(fleet.FleetError, match="a step of 0 s is not possible"):
        fleet.assess([str(logs)], str(out), step_s=0)


def test_deleted_logs_are_kept_and_marked(logs, tmp_path, here):
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out), recursive=True)
    away = tmp_path / "away.csv"
    (logs / "vehicle=v2" / "2.csv").rename(away)
    # A log of a source that is not listed this time is not missing.
    fleet.assess([str(logs)], str(out))
    assert not any(row["deleted"] for row in flights(out).values())
    fleet.assess([str(logs)], str(out), recursive=True)
    assert [name for name, row in flights(out).items() if row["deleted"]] == ["2.csv"]
    away.rename(logs / "vehicle=v2" / "2.csv")
    assert fleet.assess([str(logs)], str(out), recursive=True).assessed == 0
    assert not any(row["deleted"] for row in flights(out).values())


def test_nothing_is_written_in_a_dry_run(logs, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["assess", str(logs), "--out", str(out), "--dry-run"]) == 0
    assert "3 logs" in capsys.readouterr().err and not out.exists()


class Killed(BaseException):
    """Ends a process."""


def test_an_interruption_after_any_write_is_repaired(logs, tmp_path, here, monkeypatch):
    """A run killed at its nth write, followed by a complete run, gives the dataset of an undisturbed run."""
    whole = tmp_path / "whole"
    fleet.assess([str(logs)], str(whole), recursive=True)
    original = fleet.storage.Place.write
    for last in range(60):
        out = tmp_path / f"out{last}"
        left = last

        def write(place, path, data):
            nonlocal left
            if left == 0:
                raise Killed
            left -= 1
            original(place, path, data)

        monkeypatch.setattr(fleet.storage.Place, "write", write)
        try:
            fleet.assess([str(logs)], str(out), recursive=True)
        except Killed:
            monkeypatch.setattr(fleet.storage.Place, "write", original)
            fleet.assess([str(logs)], str(out), recursive=True)
            assert content(out) == content(whole), f"killed at write {last}"
        else:
            break
    assert last > 10, "the run ended before it was killed"


def change_some(logs: Path) -> None:
    for number in (1, 3, 4):
        (logs / f"vehicle=v{number}" / f"{number}.csv").write_text(csv(number + 30))
    (logs / "vehicle=v5" / "5.csv").unlink()


def test_commands_that_replace_rows_can_be_interrupted(logs, tmp_path, here, monkeypatch):
    """A run over changed and deleted logs, or a compaction, is killed at a write or a deletion, and repaired by the next."""
    first = tmp_path / "first"
    fleet.assess([str(logs)], str(first), recursive=True)
    fleet.compact(str(first))
    change_some(logs)
    whole = tmp_path / "whole"
    shutil.copytree(first, whole)
    fleet.assess([str(logs)], str(whole), recursive=True)
    fleet.compact(str(whole))
    original = {name: getattr(fleet.storage.Place, name) for name in ("write", "delete")}
    for last in range(100):
        out = tmp_path / "out"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(first, out)
        left = last

        def counted(name):
            def call(*arguments):
                nonlocal left
                if left == 0:
                    raise Killed
                left -= 1
                original[name](*arguments)

            return call

        for name in original:
            monkeypatch.setattr(fleet.storage.Place, name, counted(name))
        try:
            fleet.assess([str(logs)], str(out), recursive=True)
            fleet.compact(str(out))
            was_killed = False
        except Killed:
            was_killed = True
        for name, function in original.items():
            monkeypatch.setattr(fleet.storage.Place, name, function)
        fleet.assess([str(logs)], str(out), recursive=True)
        assert content(out) == content(whole), f"killed at change {last}"
        if not was_killed:
            break
    assert last > 10, "the run ended before it was killed"


def test_a_worker_of_an_earlier_run_commits_nothing(logs, tmp_path):
    out = tmp_path / "out"
    place = open_place(str(out))
    job = fleet.Job.of(str(out), flagred.Profile(), 1.0, False).of_run(takeover.take_over(place))
    listed = [(str(logs), log) for log in open_place(str(logs)).logs(False, fleet.storage.LOGS)]
    shard, *rest = shards(listed, 1 << 30)
    assert not rest and len(shard.logs) == 3
    takeover.take_over(place)
    with pytest.raises(takeover.Superseded, match="another run writes"):
        fleet.process(shard, job)
    assert not (out / "flights").exists()


def test_two_rows_of_a_log_become_one(logs, tmp_path, here):
    """A log has two rows if a worker of an earlier run commits while the next run begins."""
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out), recursive=True)
    before = content(out)
    for kind in ("flights", "steps"):
        for file in list((out / kind).rglob("*.parquet")):
            shutil.copy(file, file.with_name("late.parquet"))
    assert len(table(out, "flights")) > 9
    fleet.assess([str(logs)], str(out), recursive=True)
    assert content(out) == before


def test_a_vanished_log_has_no_row_and_a_busy_storage_is_retried(logs, tmp_path, monkeypatch):
    out = tmp_path / "out"
    place = open_place(str(out))
    job = fleet.Job.of(str(out), flagred.Profile(), 1.0, True).of_run(takeover.take_over(place))
    listed = sorted(open_place(str(logs)).logs(True, ["*.csv"]), key=lambda log: log.path)
    Path(listed[0].path).unlink()
    monkeypatch.setattr(sys.modules["flagred.fleet.process"], "TRIES_S", (0.0, 0.0))
    original, asked = fleet.storage.Place.read, []

    def read(place, path):
        if path.endswith(("1.csv", "2.csv")):
            asked.append(path)
            if path.endswith("2.csv") or len(asked) < 3:
                raise OSError("503 slow down")
        return original(place, path)

    monkeypatch.setattr(fleet.storage.Place, "read", read)
    outcome = fleet.process(fleet.Shard(str(logs), tuple(listed)), job)
    assert (outcome.logs, outcome.not_assessed, outcome.unchanged) == (6, 1, 1)
    rows = flights(out)
    assert len(rows) == 5 and rows["1.csv"]["status"] == "assessed"
    assert (rows["2.csv"]["status"], rows["2.csv"]["error"]) == ("unavailable", "503 slow down")
    # The next run requests the unavailable log again.
    with Catalog(job.settings) as catalog:
        source = open_place(str(logs))
        catalog.take_in(source, source.logs(True, ["*.csv"]))
        catalog.load(place)
        assert [Path(log.path).name for _, log in catalog.todo()] == ["2.csv"]


def test_a_dataset_of_another_version_is_refused(logs, tmp_path, here):
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out))
    file = next((out / "flights").rglob("*.parquet"))
    old = pq.ParquetFile(file).read().replace_schema_metadata({"flagred.fleet": "0"})
    pq.write_table(old, file)
    with pytest.raises(fleet.FleetError, match="has version 0 of the tables"):
        fleet.assess([str(logs)], str(out))


def test_shards_are_cut_by_size_and_source():
    logs = [("a", fleet.Log(str(i), 40, 0)) for i in range(5)] + [("b", fleet.Log("x", 500, 0)), ("b", fleet.Log("y", 1, 0))]
    cut = [(shard.source, len(shard.logs), shard.bytes) for shard in shards(logs, 100)]
    assert cut == [("a", 2, 80), ("a", 2, 80), ("a", 1, 40), ("b", 1, 500), ("b", 1, 1)]
    one = next(shards(logs, 200))
    assert one.id == next(shards(logs, 200)).id and one.id != one.halves()[0].id
    assert one.halves()[0].logs + one.halves()[1].logs == one.logs


def test_a_small_fleet_uses_all_cores():
    logs = [("a", fleet.Log(str(i), 3_000_000, 0)) for i in range(108)]
    parts = list(shards(logs, *largest(108, 324_000_000, 16)))
    assert len(parts) >= 54 and max(len(part.logs) for part in parts) <= 2
    assert len(list(shards(logs, *largest(108, 324_000_000, 1)))) == 4
    # A large fleet has the largest shards, and small logs do not form a single shard.
    assert largest(1_000_000, 4 << 40, 16) == (128 << 20, 1000)
    assert largest(40, 40_000, 2)[1] == 5


def test_names_of_logs():
    wanted = matcher(fleet.storage.LOGS)
    assert wanted("/a/b/FLIGHT.BIN") and wanted("x.ulg.gz") and not wanted("a.bin/readme.md")
    assert absolute("s3://bucket/logs") == "s3://bucket/logs" and absolute("logs").startswith("/")
    with pytest.raises(fleet.FleetError, match="cannot be opened"):
        open_place("ftp://host/logs")


def test_the_command_line_on_all_cores(logs, tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["assess", str(logs), "--recursive", "--out", str(out), "--workers", "2"]
    assert main(arguments) == 0
    said = capsys.readouterr()
    assert said.out == "9 logs read, 0 of them unchanged, 2 not assessed\n" and "dashboard: http://127.0.0.1" in said.err
    assert len(flights(out)) == 9
    assert main(arguments) == 0
    assert capsys.readouterr().out == "0 logs read, 0 of them unchanged, 0 not assessed\n"
    assert main(["assess", str(tmp_path / "none"), "--out", str(out)]) == 2
    assert "there is no" in capsys.readouterr().err


def test_a_log_that_ends_its_worker_is_found(logs, tmp_path, monkeypatch):
    """The workers' `read_log` kills them at one of the logs, like running out of memory."""
    plugin = tmp_path / "plugin"
    plugin.mkdir()
    (plugin / "sitecustomize.py").write_text(
        "import os, flagred\n"
        "import flagred.fleet.rows as rows\n"
        "read_log = rows.read_log\n"
        "def lethal(log, *arguments, **named):\n"
        "    if str(log).endswith('3.csv'):\n"
        "        os.kill(os.getpid(), 9)\n"
        "    return read_log(log, *arguments, **named)\n"
        "rows.read_log = lethal\n"
    )
    path = os.pathsep.join(filter(None, [str(plugin), os.environ.get("PYTHONPATH")]))
    monkeypatch.setenv("PYTHONPATH", path)
    out = tmp_path / "out"
    done = fleet.assess([str(logs)], str(out), recursive=True, workers=2)
    assert (done.assessed, done.not_assessed) == (9, 3)
    rows = flights(out)
    assert {name: row["status"] for name, row in rows.items() if row["status"] not in ("assessed", "unreadable")} == {"3.csv": "crashed"}
    assert len(rows) == 9
    monkeypatch.delenv("PYTHONPATH")
    assert fleet.assess([str(logs)], str(out), recursive=True, workers=2).assessed == 0


def test_a_full_disk_stops_the_run_before_logs_are_read_again(logs, tmp_path, monkeypatch, capsys):
    """In the workers, writing steps fails as on a full disk. Each log is read at most once."""
    plugin = tmp_path / "plugin"
    plugin.mkdir()
    (plugin / "sitecustomize.py").write_text(
        "import errno, flagred\n"
        "import flagred.fleet.rows as rows\n"
        "from flagred.fleet.storage import Place\n"
        "read_log, write = rows.read_log, Place.write\n"
        "def counted(log, *arguments, **named):\n"
        f"    open({str(tmp_path / 'read')!r}, 'a').write(f'{{log}}\\n')\n"
        "    return read_log(log, *arguments, **named)\n"
        "def full(place, path, content):\n"
        "    if '/steps/' in path:\n"
        "        raise OSError(errno.ENOSPC, 'No space left on device')\n"
        "    write(place, path, content)\n"
        "rows.read_log, Place.write = counted, full\n"
    )
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [str(plugin), os.environ.get("PYTHONPATH")])))
    arguments = ["assess", str(logs), "--recursive", "--out", str(tmp_path / "out"), "--workers", "2"]
    assert main(arguments) == 2
    assert "the dataset cannot be written: [Errno 28] No space left on device" in capsys.readouterr().err
    read = (tmp_path / "read").read_text().splitlines()
    assert 0 < len(read) == len(set(read)) <= 9
    monkeypatch.delenv("PYTHONPATH")
    assert main(arguments) == 0 and len(flights(tmp_path / "out")) == 9


def test_a_disk_without_space_is_noticed_before_logs_are_read(logs, tmp_path, monkeypatch):
    out = tmp_path / "out"
    job = fleet.Job.of(str(out), flagred.Profile(), 1.0, False).of_run(takeover.take_over(open_place(str(out))))
    listed = [(str(logs), log) for log in open_place(str(logs)).logs(False, fleet.storage.LOGS)]
    (shard,) = shards(listed, 1 << 30)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: shutil._ntuple_diskusage(10**9, 10**9 - 5000, 5000))
    monkeypatch.setattr("flagred.fleet.rows.read_log", lambda *arguments, **named: pytest.fail("a log was read"))
    with pytest.raises(OSError, match="only 5000 bytes are left on the disk"):
        fleet.process(shard, job)


def test_a_worker_that_dask_lost_is_replaced(monkeypatch):
    monkeypatch.setattr(engine, "LONGEST_RESTART_S", 1.0)
    with engine.cluster(None, 1) as client:
        client.wait_for_workers(1)
        (nanny,) = client.cluster.workers.values()
        # As if a worker ends while it starts.
        nanny.status = Status.starting
        os.kill(nanny.pid, 9)
        attendance = engine._Attendance(client)

        def wait_for(workers: int) -> None:
            end_s = time.monotonic() + 60
            while attendance.count() != workers:
                assert time.monotonic() < end_s, f"there are not {workers} workers"
                time.sleep(0.05)

        wait_for(0)
        wait_for(1)
        monkeypatch.setattr(engine, "LONGEST_ALONE_S", -1.0)
        with pytest.raises(fleet.FleetError, match="there was no worker"):
            attendance.count()


def odd_folder(tmp_path: Path) -> Path:
    """Two logs, and other entries of a folder."""
    folder = tmp_path / "odd"
    (folder / "below").mkdir(parents=True)
    (folder / "0.csv").write_text(csv(0))
    (folder / "below" / "1.csv").write_text(csv(1))
    with open(os.fsencode(folder) + b"/\xff.csv", "w") as file:
        file.write(csv(2))
    os.mkfifo(folder / "pipe.bin")
    os.symlink(folder, folder / "below" / "loop")
    os.symlink(folder / "0.csv", folder / "below" / "again.csv")
    os.link(folder / "0.csv", folder / "below" / "hard.csv")
    os.symlink(tmp_path / "nowhere", folder / "broken.bin")
    os.symlink("/dev/zero", folder / "zero.bin")
    return folder


def test_each_file_counts_once_and_other_entries_are_skipped(tmp_path, here, capsys):
    folder, out = odd_folder(tmp_path), tmp_path / "out"
    done = fleet.assess([str(folder)], str(out), recursive=True)
    assert (done.listed, done.assessed, done.passed_over) == (2, 2, 4)
    assert sorted(flights(out)) == ["0.csv", "1.csv"]
    # The folder is given twice, and through a link.
    os.symlink(folder, tmp_path / "link")
    sources = [str(folder), str(folder / "below"), str(tmp_path / "link")]
    assert fleet.assess(sources, str(out), recursive=True, dry_run=True).listed == 2
    assert main(["assess", str(folder), "--out", str(out), "--dry-run"]) == 0
    assert "4 skipped: the name is not UTF-8, or it is not a file" in capsys.readouterr().err


def test_a_link_to_a_log_elsewhere_counts(tmp_path, here):
    folder, other = tmp_path / "logs", tmp_path / "elsewhere"
    folder.mkdir()
    other.mkdir()
    (other / "0.csv").write_text(csv(0))
    os.symlink(other / "0.csv", folder / "a.csv")
    os.symlink(other / "0.csv", folder / "b.csv")
    out = tmp_path / "out"
    fleet.assess([str(folder)], str(out))
    assert list(flights(out)) == ["a.csv"]


def test_a_source_that_is_neither_folder_nor_file(tmp_path, here):
    os.mkfifo(tmp_path / "pipe.bin")
    with pytest.raises(fleet.FleetError, match="neither a folder nor a file"):
        fleet.assess([str(tmp_path / "pipe.bin")], str(tmp_path / "out"))
    for kind in ("file", "folder"):
        with pytest.raises(fleet.FleetError, match=r"\\xff` is not UTF-8") as raised:
            fleet.assess([str(tmp_path) + "/\udcff"], str(tmp_path / "out"))
        assert raised.value.help == f"rename the {kind}"
        os.makedirs(os.fsencode(tmp_path) + b"/\xff", exist_ok=True)


def test_hard_links_to_one_file_that_are_sources_count_once(tmp_path, here):
    (tmp_path / "0.csv").write_text(csv(0))
    os.link(tmp_path / "0.csv", tmp_path / "again.csv")
    sources = [str(tmp_path / "0.csv"), str(tmp_path / "again.csv")]
    assert fleet.assess(sources, str(tmp_path / "out"), dry_run=True).listed == 1


def test_without_extras_the_command_names_the_packages_to_install(tmp_path):
    (tmp_path / "dask.py").write_text("raise ModuleNotFoundError('no dask', name='dask')")
    paths = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": paths}
    for arguments in (["-m", "flagred.fleet", "--help"], ["-c", "import flagred.fleet"]):
        done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment)
        assert done.returncode != 0 and "pip install 'flagred[fleet]'" in done.stderr
        assert arguments[0] == "-c" or done.stderr.count("\n") == 1


def tear(file: Path) -> Path:
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    return file


def weak(number: int) -> str:
    """A flight with a finding: a motor at its limit."""
    return csv(number).replace(",0.4,", ",1,")


@pytest.mark.parametrize("kind", ["flights", "findings", "steps"])
def test_a_torn_file_of_the_dataset_is_named(kind, logs, tmp_path, here, capsys):
    pytest.importorskip("duckdb")
    out = tmp_path / "out"
    (logs / "vehicle=v0" / "weak.csv").write_text(weak(0))
    (logs / "vehicle=v5" / "weak.csv").write_text(weak(5))
    fleet.assess([str(logs)], str(out), recursive=True)
    # The last file is damaged, because DuckDB opens the first one in any case.
    torn = tear(sorted((out / kind).rglob("*.parquet"))[-1])
    assert main(["report", str(out), "-o", str(tmp_path / "fleet.html")]) == 3
    told = capsys.readouterr().err
    assert f"`{torn}` is damaged" in told and "help: restore the file, or delete all files with its name" in told
    assert main(["compact", str(out)]) == 3
    assert f"`{torn}` is damaged" in capsys.readouterr().err
    if kind == "flights":
        assert main(["assess", str(logs), "--out", str(out)]) == 3
        assert f"`{torn}` is damaged" in capsys.readouterr().err
        torn.unlink()
        assert main(["assess", str(logs), "--out", str(out), "--recursive"]) == 0


@pytest.mark.parametrize("kind", ["findings", "steps"])
def test_assess_reads_the_logs_of_a_torn_part_again(kind, logs, tmp_path, here, capsys):
    out = tmp_path / "out"
    (logs / "vehicle=v5" / "weak.csv").write_text(weak(5))
    arguments = ["assess", str(logs), "--recursive", "--out", str(out)]
    assert main(arguments) == 0
    before = content(out)
    torn = tear(sorted((out / kind).rglob("*.parquet"))[-1])
    capsys.readouterr()
    assert main([*arguments, "--dry-run"]) == 0
    assert f"warning: `{torn}` is damaged" in capsys.readouterr().err and torn.exists()
    assert main(arguments) == 0
    told = capsys.readouterr()
    assert f"warning: `{torn}` is damaged" in told.err and not told.out.startswith("0 logs")
    assert content(out) == before
    assert main(arguments) == 0
    assert capsys.readouterr().out.startswith("0 logs read")
    # A damaged file is not replaced if its logs were deleted: their rows would be lost.
    torn = tear(sorted((out / kind).rglob("*.parquet"))[-1])
    shutil.rmtree(logs)
    logs.mkdir()
    assert main(arguments) == 3
    told = capsys.readouterr().err
    assert f"`{torn}` is damaged" in told and "name the sources of all its logs" in told and "help: restore the file" in told
    assert torn.exists() and main(["compact", str(out)]) == 3


@pytest.mark.parametrize("kind", ["findings", "steps"])
def test_a_part_that_is_missing_is_named_and_its_logs_are_read_again(kind, logs, tmp_path, here, capsys):
    pytest.importorskip("duckdb")
    out = tmp_path / "out"
    (logs / "vehicle=v5" / "weak.csv").write_text(weak(5))
    arguments = ["assess", str(logs), "--recursive", "--out", str(out)]
    assert main(arguments) == 0
    before = content(out)
    lost = sorted((out / kind).rglob("*.parquet"))[-1]
    lost.unlink()
    capsys.readouterr()
    assert main(["compact", str(out)]) == 3
    assert f"`{lost}` is missing" in capsys.readouterr().err
    if kind == "findings":
        assert main(["report", str(out), "-o", str(tmp_path / "fleet.html")]) == 3
        told = capsys.readouterr().err
        assert "the findings of `" in told and "` are missing in `" in told and "help: run `assess` again" in told
    assert main(arguments) == 0
    assert f"warning: `{lost}` is missing" in capsys.readouterr().err
    assert content(out) == before
    # A missing file is not replaced if its logs were deleted: their rows would be lost.
    sorted((out / kind).rglob("*.parquet"))[-1].unlink()
    shutil.rmtree(logs)
    logs.mkdir()
    assert main(arguments) == 3
    assert "name the sources of all its logs" in capsys.readouterr().err


def test_damage_inside_a_part_is_named(logs, tmp_path, here, capsys):
    pytest.importorskip("duckdb")
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out), recursive=True)
    for kind, commands in (("steps", ["compact"]), ("flights", ["compact", "report"])):
        # A month with one file has nothing to join.
        months = [sorted(month.glob("*.parquet")) for month in (out / kind).iterdir()]
        files = [file for month in months if len(month) > 1 for file in month]
        assert files
        for file in files:
            whole = file.read_bytes()
            column = pq.ParquetFile(file).metadata.row_group(0).column(0)
            end = (column.dictionary_page_offset or column.data_page_offset) + column.total_compressed_size
            file.write_bytes(whole[: end - 8] + bytes(byte ^ 0xFF for byte in whole[end - 8 : end]) + whole[end:])
            for command in commands:
                more = ["-o", str(tmp_path / "fleet.html")] if command == "report" else []
                assert main([command, str(out), *more]) == 3
                told = capsys.readouterr().err
                assert f"`{file}` is damaged" in told and "help: restore the file" in told, told
            file.write_bytes(whole)
    assert main(["compact", str(out)]) == 0


@pytest.mark.parametrize("text", ["", '{"run": "12', "[]", "{}"])
def test_a_torn_file_of_the_run_is_named_and_written_anew(text, logs, tmp_path, here, capsys):
    pytest.importorskip("duckdb")
    out = tmp_path / "out"
    fleet.assess([str(logs)], str(out), recursive=True)
    file = out / takeover.RUN
    file.write_text(text)
    for command in (["report", str(out), "-o", str(tmp_path / "fleet.html")], ["compact", str(out)]):
        assert main(command) == 3
        told = capsys.readouterr().err
        assert f"`{file}` is damaged" in told and "help: run `assess`" in told
    assert main(["assess", str(logs), "--out", str(out), "--recursive"]) == 0
    assert f"warning: `{file}` is damaged" in capsys.readouterr().err
    assert main(["compact", str(out)]) == 0
