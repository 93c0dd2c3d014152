"""Shards: groups of logs that are read and written together, and the job that they belong to."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from .. import Profile
from .storage import Log

__all__ = ["Job", "Shard", "largest", "shards"]

MAX_BYTES = 128 << 20
"""The maximum size of a shard, unless it is one log."""
MAX_LOGS = 1000
"""The maximum number of logs of a shard, if they are small."""
PER_CORE = 4
"""The minimum number of shards per core, if there are as many logs: the cores then finish at about the same time."""


@dataclass(frozen=True)
class Job:
    """The common settings of all shards of a run, which are sent to the workers."""

    run: str
    """The id of the run: workers of a replaced run stop writing."""
    out: str
    """The dataset."""
    profile: Profile
    settings: str
    """The settings that determine the results: the hash of the profile and its rules, and the step."""
    step_s: float
    compare_content: bool
    """Whether contents are hashed, so that a log with unchanged content is the same log whatever its modification time."""

    @staticmethod
    def of(out: str, profile: Profile, step_s: float, compare_content: bool) -> Job:
        hash = hashlib.sha256(f"{profile.text}\0{profile.rules_text}".encode()).hexdigest()[:16]
        return Job("", out, profile, f"{hash} every {step_s:g} s", step_s, compare_content)

    def of_run(self, run: str) -> Job:
        """The same job for a run."""
        return replace(self, run=run)


@dataclass(frozen=True)
class Shard:
    """Logs of one source that are read and written together."""

    source: str
    """The folder of the logs."""
    logs: tuple[Log, ...]
    crashed: bool = False
    """Whether its only log killed every worker that read it: it is recorded and not read again."""

    @property
    def id(self) -> str:
        """An identifier of its logs: the same logs are always written to the same files."""
        text = "\n".join(f"{log.path} {log.identity}" for log in self.logs)
        return hashlib.sha256(text.encode()).hexdigest()[:20]

    @property
    def bytes(self) -> int:
        """The size of its logs."""
        return sum(log.bytes for log in self.logs)

    def halves(self) -> tuple[Shard, Shard]:
        """The two halves of the shard, to find the log that kills its worker."""
        middle = len(self.logs) // 2
        return replace(self, logs=self.logs[:middle]), replace(self, logs=self.logs[middle:])


def largest(logs: int, bytes: int, cores: int) -> tuple[int, int]:
    """The maximum bytes and logs of a shard, chosen so that a small fleet uses all cores too."""
    parts = PER_CORE * max(1, cores)
    return min(MAX_BYTES, -(-bytes // parts)), max(1, min(MAX_LOGS, -(-logs // parts)))


def shards(logs: Iterable[tuple[str, Log]], most_bytes: int, most_logs: int = MAX_LOGS) -> Iterator[Shard]:
    """Divides logs with their sources, in order, into shards. A log larger than the limit is a shard of its own."""
    part: list[Log] = []
    size = 0
    of = ""
    for source, log in logs:
        if part and (source != of or size + log.bytes > most_bytes or len(part) >= most_logs):
            yield Shard(of, tuple(part))
            part, size = [], 0
        of = source
        part.append(log)
        size += log.bytes
    if part:
        yield Shard(of, tuple(part))
