"""Shards: the logs that are read and written together, and the job that they belong to."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from .. import Profile
from .storage import Log

__all__ = ["Job", "Shard", "largest", "shards"]

MOST_BYTES = 128 << 20
"""The most bytes of a shard, unless it is one log."""
MOST_LOGS = 1000
"""The most logs of a shard, where they are small."""
PER_CORE = 4
"""How many shards each core gets at least, if there are as many logs: the cores then finish at about the same time."""


@dataclass(frozen=True)
class Job:
    """What all shards of a run have in common. It goes to the workers."""

    run: str
    """The id of the run: a worker of a run that another one has replaced writes no more."""
    out: str
    """The dataset."""
    profile: Profile
    settings: str
    """What the answers depend on: hash of the profile and its rules, and the step."""
    step_s: float
    compare_content: bool
    """Whether contents are hashed, and a log of the same content is the same log whatever its time."""

    @staticmethod
    def of(out: str, profile: Profile, step_s: float, compare_content: bool) -> Job:
        hash = hashlib.sha256(f"{profile.text}\0{profile.rules_text}".encode()).hexdigest()[:16]
        return Job("", out, profile, f"{hash} every {step_s:g} s", step_s, compare_content)

    def of_run(self, run: str) -> Job:
        """The same job of a run."""
        return replace(self, run=run)


@dataclass(frozen=True)
class Shard:
    """Logs of one source that are read and written together."""

    source: str
    """The place of the logs."""
    logs: tuple[Log, ...]
    crashed: bool = False
    """Its one log ended every worker that read it: it is written down and not read again."""

    @property
    def id(self) -> str:
        """A name of its logs: the same logs are written to the same files, however often."""
        text = "\n".join(f"{log.path} {log.identity}" for log in self.logs)
        return hashlib.sha256(text.encode()).hexdigest()[:20]

    @property
    def bytes(self) -> int:
        """The size of its logs."""
        return sum(log.bytes for log in self.logs)

    def halves(self) -> tuple[Shard, Shard]:
        """The shard in two, to find the log that ends its worker."""
        middle = len(self.logs) // 2
        return replace(self, logs=self.logs[:middle]), replace(self, logs=self.logs[middle:])


def largest(logs: int, bytes: int, cores: int) -> tuple[int, int]:
    """The most bytes and the most logs of a shard, so that a small fleet employs all cores, too."""
    parts = PER_CORE * max(1, cores)
    return min(MOST_BYTES, -(-bytes // parts)), max(1, min(MOST_LOGS, -(-logs // parts)))


def shards(logs: Iterable[tuple[str, Log]], most_bytes: int, most_logs: int = MOST_LOGS) -> Iterator[Shard]:
    """Logs with their sources, in their order, cut into shards. A log that is larger than a shard is one alone."""
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
