"""Dask as the engine: all local cores, or a cluster with the address of its scheduler. Only this module uses Dask."""

from __future__ import annotations

import errno
import logging
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import replace

import dask
from dask.system import CPU_COUNT
from distributed import Client, Future, KilledWorker, LocalCluster, as_completed
from distributed.comm import CommClosedError
from distributed.system import MEMORY_LIMIT

from .errors import FleetError
from .process import Outcome, process
from .shards import Job, Shard
from .takeover import Superseded

__all__ = ["cluster", "cores", "run"]

MAX_WORKER_BYTES = 2 << 30
"""The memory limit of a local worker in bytes. A worker that exceeds it is killed, and its log is recorded as crashed."""
TRIES = 2
"""A shard that kills its local worker this many times is split."""
RETRIES = 2
"""How many times a shard is processed again after an error of writing its files."""
LONGEST_ALONE_S = 600.0
"""How long a cluster may be without workers."""
LONGEST_RESTART_S = 30.0
"""How long a local worker may take to restart. Dask does not restart a worker that ends while it starts."""
POLL_S = 0.05


@contextmanager
def cluster(scheduler: str | None, workers: int | None) -> Iterator[Client]:
    """A client of a running cluster, or of a local one that starts and ends with it."""
    # For a local cluster: limits how many workers a task may kill, and disables the time-out for workers that restart.
    settings = {"distributed.scheduler.allowed-failures": TRIES - 1, "distributed.deploy.lost-worker-timeout": "1d"}
    with dask.config.set(settings):
        if scheduler is not None:
            try:
                client = Client(scheduler, timeout="10s", set_as_default=False)
            except (OSError, ValueError) as error:
                raise FleetError(f"no scheduler answers at `{scheduler}`: {error}", "start one with `dask scheduler`") from error
            with client:
                yield client
            return
        count = workers or CPU_COUNT
        local = LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            memory_limit=min(MAX_WORKER_BYTES, MEMORY_LIMIT * 2 // (3 * count)),
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        )
        with local, Client(local, set_as_default=False) as client:
            yield client


def cores(client: Client) -> int:
    """The number of shards that the cluster processes at a time; a cluster without workers counts as this machine."""
    here = client.cluster
    return len(here.worker_spec) if isinstance(here, LocalCluster) else sum(client.nthreads().values()) or CPU_COUNT


def run(client: Client, shards: Iterator[Shard], job: Job, wait: Callable[[int], None]) -> Iterator[Outcome]:
    """Yields the outcome of each shard when it is known. Only some shards are submitted at a time.

    A shard that repeatedly kills its worker is split in halves after all other shards are done. A half that still kills
    its worker is split again, until one log is left, which is recorded as crashed. Only one shard is then submitted at a
    time, so that no other shard is blamed.

    Parameters
    ----------
    wait
        Called while there is no new outcome, with the number of workers.

    Raises
    ------
    FleetError
        The scheduler or all workers are lost, the dataset cannot be written, or another run writes to it.
    """
    suspects: deque[Shard] = deque()
    for shard, result in _under_way(client, shards, job, wait):
        if isinstance(result, Outcome):
            yield result
        else:
            suspects.append(shard)
    while suspects:
        shard = suspects.popleft()
        (_, result), *_ = _under_way(client, iter([shard]), job, wait)
        if isinstance(result, Outcome):
            yield result
        elif shard.crashed:
            raise FleetError(f"a worker crashed on a log: {result}") from result
        elif len(shard.logs) == 1:
            suspects.appendleft(replace(shard, crashed=True))
        else:
            suspects.extendleft(shard.halves())


def _under_way(
    client: Client, shards: Iterator[Shard], job: Job, wait: Callable[[int], None]
) -> Iterator[tuple[Shard, Outcome | BaseException]]:
    """Yields each shard with its outcome, or with the error that stopped it."""
    waiting: dict[Future, Shard] = {}
    done = as_completed(loop=client.loop)

    def submit() -> None:
        most = 3 * max(1, sum(client.nthreads().values()))
        while len(waiting) < most and (shard := next(shards, None)) is not None:
            future = client.submit(_attempt, shard, job, key=f"flagred-{shard.id}-{time.monotonic_ns()}", pure=False, retries=RETRIES)
            waiting[future] = shard
            done.add(future)

    submit()
    attendance = _Attendance(client)
    while waiting:
        finished: list[Future] = done.next_batch(block=False)
        if not finished:
            wait(attendance.count())
            if client.status != "running":
                raise _lost()
            time.sleep(POLL_S)
            continue
        for future in finished:
            if future.status in ("pending", "lost"):
                # The worker ended before the outcome was fetched, so the shard is submitted again.
                done.add(future)
            else:
                yield waiting.pop(future), _result(future)
        submit()


class _Attendance:
    """The number of workers. Missing local workers are replaced; a cluster without any is given up."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._seen_s = self._complete_s = time.monotonic()

    def count(self) -> int:
        workers = len(self._client.scheduler_info(n_workers=-1)["workers"])
        here, now_s = self._client.cluster, time.monotonic()
        wanted = len(here.worker_spec) if isinstance(here, LocalCluster) else workers
        if workers:
            self._seen_s = now_s
        if workers >= wanted:
            self._complete_s = now_s
        if now_s - self._complete_s > LONGEST_RESTART_S:
            self._complete_s = now_s
            # A worker that is still starting is not closed: by then it may read a log, which would be blamed for its end.
            for name, watcher in list(here.workers.items()):
                if not watcher.is_alive():
                    del here.workers[name]
                    here.loop.add_callback(watcher.close)
            here.scale(wanted)
        if now_s - self._seen_s > LONGEST_ALONE_S:
            raise FleetError(f"there was no worker for {LONGEST_ALONE_S:.0f} s", "run the same command again with workers")
        return workers


IN_VAIN = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EPERM)
"""Errors of writing that would occur again: a full disk, an exhausted quota, a lack of permission."""


def _attempt(shard: Shard, job: Job) -> Outcome | OSError:
    """The outcome of a shard, or an error that a repetition would not avoid. Dask would repeat a task that raises, and read
    all logs again."""
    try:
        return process(shard, job)
    except OSError as error:
        if error.errno in IN_VAIN:
            return error
        raise


def _result(future: Future) -> Outcome | BaseException:
    if future.status not in ("finished", "error"):
        raise _lost()
    try:
        outcome: Outcome | OSError = future.result()
        if isinstance(outcome, OSError):
            raise outcome
        return outcome
    except (CancelledError, CommClosedError) as error:
        raise _lost() from error
    except Superseded:
        raise
    except OSError as error:
        raise FleetError(f"the dataset cannot be written: {error}", "make the dataset writable, then run the same command again") from error
    except Exception as error:  # KilledWorker, or a bug that one log triggers: splitting finds that log.
        if not isinstance(error, KilledWorker):
            logging.getLogger(__name__).warning("a shard failed and is split: %r", error)
        return error


def _lost() -> FleetError:
    return FleetError("the scheduler was lost", "run the same command again: it continues with the missing logs")
