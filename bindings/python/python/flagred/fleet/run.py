"""A run: assesses and writes the logs that are missing in a dataset."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Protocol

from .. import Profile
from . import engine
from .catalog import Catalog, Counts
from .errors import DamagedError, FleetError
from .listing import Listing
from .process import Outcome
from .repair import redo, repair
from .shards import Job, Shard, largest, shards
from .storage import LOGS, Log, Place, absolute, matcher, open_place
from .takeover import check, take_over

__all__ = ["Assessed", "Plan", "Watcher", "assess", "plan"]


@dataclass(frozen=True)
class Assessed:
    """The results of a run."""

    listed: int
    """Logs at the sources."""
    assessed: int
    """Logs that were read in this run."""
    bytes: int
    """The size of these logs."""
    not_assessed: int
    """Read logs without an assessment; their rows contain the reasons."""
    unchanged: int
    """Read logs with unchanged content."""
    passed_over: int
    """Names of logs at the sources that are not readable files: not UTF-8, a FIFO, a device, a broken link."""


class Watcher(Protocol):
    """Receives the progress of a run."""

    def planned(self, counts: Counts) -> None:
        """Called after the sources are listed."""

    def started(self, dashboard: str) -> None:
        """Called when the engine runs; its dashboard is at this address."""

    def went_on(self, done: Assessed, workers: int | None) -> None:
        """Called when a shard is done or some time has passed, with the number of workers if it is known."""


class _Nobody:
    def planned(self, counts: Counts) -> None: ...
    def started(self, dashboard: str) -> None: ...
    def went_on(self, done: Assessed, workers: int | None) -> None: ...


def assess(
    sources: Sequence[str],
    out: str,
    *,
    profile: Profile | str = "flagred",
    step_s: float = 1.0,
    recursive: bool = False,
    include: Iterable[str] = LOGS,
    compare_content: bool = False,
    scheduler: str | None = None,
    workers: int | None = None,
    dry_run: bool = False,
    watcher: Watcher | None = None,
) -> Assessed:
    """Assesses the logs of folders that a dataset lacks, or that changed after they were assessed.

    After any interruption, the next call completes the dataset: each log has one row.

    Parameters
    ----------
    sources
        Folders of logs: paths or addresses (``s3://``, ``gs://``, ``az://``).
    out
        The dataset: a folder or such an address.
    profile
        The profile, its name, or its file.
    step_s
        The interval of the steps of the risk over time, in seconds.
    recursive
        Whether to also read subfolders.
    include
        Patterns of the names of logs.
    compare_content
        Whether to read and hash every log: a log with unchanged content counts as the same, whatever its modification time.
    scheduler
        The address of a Dask scheduler; by default, all cores of this machine are used.
    workers
        The number of processes on this machine; by default one per core.
    dry_run
        Only count logs, without assessing or writing.
    watcher
        Receives the progress.

    Raises
    ------
    FleetError
        A source cannot be listed, the engine or the dataset was lost, or the logs of a damaged file of the dataset cannot
        all be read again.
    RuleSetError
        The profile or its rule set has errors.
    """
    told = watcher or _Nobody()
    with plan(
        sources, out, profile=profile, step_s=step_s, recursive=recursive, include=include, compare_content=compare_content, dry_run=dry_run
    ) as planned:
        counts = planned.counts
        told.planned(counts)
        done = Assessed(counts.listed, 0, 0, 0, 0, counts.passed_over)
        if dry_run or not counts.new + counts.changed:
            return done
        return _work(planned, done, told, scheduler, workers)


def _work(planned: Plan, done: Assessed, told: Watcher, scheduler: str | None, workers: int | None) -> Assessed:
    with engine.cluster(scheduler, workers) as client:
        told.started(client.dashboard_link)
        cores = engine.cores(client)
        for outcome in engine.run(client, planned.shards_for(cores), planned.job, lambda workers: told.went_on(done, workers)):
            done = _sum(done, outcome)
            told.went_on(done, None)
    return done


@dataclass(frozen=True)
class Plan:
    """The work of a run: each shard must be passed to :func:`process` with the job, by any engine and in any order."""

    counts: Counts
    job: Job
    _todo: Callable[[], Iterator[tuple[str, Log]]]

    @property
    def shards(self) -> Iterator[Shard]:
        """The missing or changed logs, in shards for the cores of this machine. They are generated lazily."""
        return self.shards_for(os.cpu_count() or 1)

    def shards_for(self, cores: int) -> Iterator[Shard]:
        """The same for this many cores: a small fleet is divided more finely, so that all of them are used."""
        counts = self.counts
        return shards(self._todo(), *largest(counts.new + counts.changed, counts.todo_bytes, cores))


@contextmanager
def plan(
    sources: Sequence[str],
    out: str,
    *,
    profile: Profile | str = "flagred",
    step_s: float = 1.0,
    recursive: bool = False,
    include: Iterable[str] = LOGS,
    compare_content: bool = False,
    dry_run: bool = False,
) -> Iterator[Plan]:
    """Prepares and completes :func:`assess` for another engine: see docs/fleet.md.

    Takes over the dataset from earlier runs. When the context ends without an error, the dataset is repaired: one row per
    log.
    Parameters and errors are those of :func:`assess`.
    """
    if not step_s > 0:
        raise FleetError(f"a step of {step_s} s is not possible", "choose a number of seconds above 0")
    profile = profile if isinstance(profile, Profile) else Profile(profile)
    include = tuple(include)
    places = [open_place(absolute(source)) for source in sources]
    dataset = open_place(absolute(out))
    job = Job.of(dataset.uri, profile, step_s, compare_content)
    is_listed = _listed(places, recursive, include)
    listing = Listing(recursive, matcher(include), is_listed)
    with Catalog(job.settings, compare_content) as catalog:
        for place in places:
            catalog.take_in(place, listing.logs(place.root) if place.is_local else place.logs(recursive, include))
        damaged: tuple[DamagedError, ...] = ()
        try:
            check(dataset)
        except DamagedError as error:
            damaged = (error,)
        if not dry_run:
            # Takes over before the dataset is read, so that no earlier run commits anything unnoticed.
            job = job.of_run(take_over(dataset))
        catalog.load(dataset)
        damaged += redo(dataset, catalog, dry_run)
        counts = replace(catalog.counts(), passed_over=listing.passed_over, damaged=damaged)
        yield Plan(counts, job, catalog.todo)
        if not dry_run:
            repair(dataset, catalog, is_listed)


def _sum(done: Assessed, outcome: Outcome) -> Assessed:
    return Assessed(
        done.listed,
        done.assessed + outcome.logs,
        done.bytes + outcome.bytes,
        done.not_assessed + outcome.not_assessed,
        done.unchanged + outcome.unchanged,
        done.passed_over,
    )


def _listed(places: Sequence[Place], recursive: bool, include: Iterable[str]) -> Callable[[str], bool]:
    """Returns a function that tests whether a log would be listed if it existed."""
    wanted = matcher(include)
    roots = [place.shown(place.root) for place in places]

    def is_listed(log: str) -> bool:
        for root in roots:
            rest = log.removeprefix(root + "/")
            if log == root or (rest != log and (recursive or "/" not in rest) and wanted(log)):
                return True
        return False

    return is_listed
