"""A run: what is missing in a dataset, assessed and written."""

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
    """What a run did."""

    listed: int
    """Logs at the sources."""
    assessed: int
    """Logs that were read in this run."""
    bytes: int
    """Their size."""
    not_assessed: int
    """Those of them that have no assessment; their rows say why."""
    unchanged: int
    """Those of them whose content is that of before."""
    passed_over: int
    """Names at the sources that are those of logs, but of no readable file: not UTF-8, a FIFO, a device, a broken link."""


class Watcher(Protocol):
    """Who is told how a run goes on."""

    def planned(self, counts: Counts) -> None:
        """The sources are listed."""

    def started(self, dashboard: str) -> None:
        """The engine runs; its dashboard is at this address."""

    def went_on(self, done: Assessed, workers: int | None) -> None:
        """A shard is done, or some time went by; how many workers there are, where it is known."""


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
    """Assesses the logs of folders that a dataset does not have yet, or that changed since.

    Whatever ends it, the next call does what is missing: each log has one row.

    Parameters
    ----------
    sources
        Folders of logs: paths or addresses (``s3://``, ``gs://``, ``az://``).
    out
        The dataset: a folder or such an address.
    profile
        The profile, or its name, or its file.
    step_s
        How far apart the steps of the risk over time are, in seconds.
    recursive
        Whether the folders below are read too.
    include
        The names of logs, as patterns.
    compare_content
        Whether every log is read and hashed: one that has the content of before counts as the same, whatever its time.
    scheduler
        The address of a Dask scheduler; without it all cores of this machine work.
    workers
        How many processes work on this machine; one a core where it is None.
    dry_run
        Whether nothing is assessed and written: only counted.
    watcher
        Who is told how it goes on.

    Raises
    ------
    FleetError
        A source cannot be listed, or the engine or the dataset was lost, or a file of the dataset is damaged whose logs cannot all
        be read again.
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
    """What is to do: :func:`process` of each shard with the job, by whatever engine, in whatever order."""

    counts: Counts
    job: Job
    _todo: Callable[[], Iterator[tuple[str, Log]]]

    @property
    def shards(self) -> Iterator[Shard]:
        """The logs that are missing or changed, in shards for as many cores as this machine has. They are made one by one."""
        return self.shards_for(os.cpu_count() or 1)

    def shards_for(self, cores: int) -> Iterator[Shard]:
        """The same for so many cores: a small fleet is cut finer, so that all of them work."""
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
    """What :func:`assess` does before and after its engine, for another engine: see docs/fleet.md.

    The dataset is taken over from runs before. When the plan is left without an error the dataset is put right: one row a log.
    Parameters and errors are those of :func:`assess`.
    """
    if not step_s > 0:
        raise FleetError(f"a step of {step_s} s is none", "write a number of seconds above 0")
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
            # Before the dataset is read, so that nothing is committed unseen.
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
    """Whether a log would be listed if it were there."""
    wanted = matcher(include)
    roots = [place.shown(place.root) for place in places]

    def is_listed(log: str) -> bool:
        for root in roots:
            rest = log.removeprefix(root + "/")
            if log == root or (rest != log and (recursive or "/" not in rest) and wanted(log)):
                return True
        return False

    return is_listed
