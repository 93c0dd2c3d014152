"""Joins many small files of a month into few."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from itertools import groupby

import pyarrow as pa

from .catalog import Catalog
from .process import write
from .repair import read, repair
from .schema import KINDS
from .storage import Place, absolute, beside, open_place
from .takeover import check, take_over

__all__ = ["compact"]

MAX_BYTES = 64 << 20
"""The maximum size of the steps in a file."""


def compact(dataset: str) -> int:
    """Joins the small files of each month. Returns by how many the number of files decreased.

    An interruption loses nothing: if a flight is then in two files, the next run removes one of its rows.

    Parameters
    ----------
    dataset
        The dataset: a folder, or an address on object storage.

    Raises
    ------
    DamagedError
        A file of the dataset is damaged.
    """
    out = open_place(absolute(dataset))
    check(out)
    take_over(out)
    before = {info.path for info in out.files("flights", ".parquet")}
    with Catalog("") as catalog:
        repair(out, catalog, lambda log: False)
        for part in _parts(out):
            _join(out, part)
        repair(out, catalog, lambda log: False)
        return len(before) - len(catalog.files())


def _parts(out: Place) -> Iterator[list[str]]:
    """Files of ``flights`` of one month that can be joined."""
    sizes = {info.path: info.size for info in out.files("steps", ".parquet")}
    sizes = {beside(out, path, "flights", "steps"): size for path, size in sizes.items()}
    paths = sorted(info.path for info in out.files("flights", ".parquet"))
    for _, month in groupby(paths, lambda path: path.rpartition("/")[0]):
        part: list[str] = []
        size = 0
        for path in month:
            if part and size + sizes.get(path, 0) > MAX_BYTES:
                yield part
                part, size = [], 0
            part.append(path)
            size += sizes.get(path, 0)
        yield part


def _join(out: Place, part: list[str]) -> None:
    if len(part) < 2:
        return
    # The names of joined files sort first: of two rows of a flight, the one in the first file is kept.
    name = "0-" + hashlib.sha256("\n".join(part).encode()).hexdigest()[:20]
    joined = f"{part[0].rpartition('/')[0]}/{name}.parquet"
    for kind in KINDS:
        tables = []
        for path in part:
            try:
                tables.append(read(out, beside(out, path, kind)))
            except FileNotFoundError:
                continue
        if tables:
            write(out, beside(out, joined, kind), pa.concat_tables(tables))
    for kind in KINDS[::-1]:
        for path in part:
            out.delete(beside(out, path, kind))
