"""Locations of logs and datasets: folders and object storage, through pyarrow's file systems."""

from __future__ import annotations

import errno
import fnmatch
import os
import posixpath
import re
import shutil
import uuid
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import pyarrow as pa
import pyarrow.fs as pafs
import pyarrow.parquet as pq

from .errors import DamagedError, FleetError

__all__ = ["LOGS", "Log", "Place", "absolute", "beside", "matcher", "open_place", "parquet"]

LOGS = ("*.bin", "*.log", "*.ulg", "*.tlog", "*.csv", "*.bin.gz", "*.log.gz", "*.ulg.gz", "*.tlog.gz", "*.csv.gz")
"""The default patterns of names of logs, case-insensitive."""


@dataclass(frozen=True)
class Log:
    """A log in the listing of its folder."""

    path: str
    """Its path in the file system."""
    bytes: int
    modified_us: int
    """Its modification time, in microseconds since 1970."""
    sha256: str | None = None
    """The hash of its content at the last reading, if contents are compared."""

    @property
    def identity(self) -> str:
        """An identifier that changes with the log."""
        return f"{self.bytes}-{self.modified_us}"


@dataclass(frozen=True)
class Place:
    """A folder, local or on object storage."""

    uri: str
    fs: pafs.FileSystem
    root: str
    """The path of the folder in its file system."""
    prefix: str
    """The prefix of displayed paths, such as ``s3://``."""

    @property
    def is_local(self) -> bool:
        return isinstance(self.fs, pafs.LocalFileSystem)

    def shown(self, path: str) -> str:
        """A path in readable form, without keys and options of the storage."""
        return self.prefix + path

    def file(self, *parts: str) -> str:
        """The path of a file in it."""
        return posixpath.join(self.root, *parts)

    def logs(self, recursive: bool, include: Iterable[str]) -> Iterator[Log]:
        """The logs in it, as the storage lists them; for local folders see :class:`Listing`. Its subfolders are listed one
        at a time, to bound the memory."""
        found = self.fs.get_file_info(self.root)
        if found.type == pafs.FileType.File:
            yield _log(found)
            return
        if found.type == pafs.FileType.NotFound:
            help = "the folder must exist; in object storage, at least one key must begin with this path"
            raise FleetError(f"there is no `{self.shown(self.root)}`", help)
        wanted = matcher(include)
        # Keeps only the folders, so that the listings can be released one by one.
        folders = []
        for info in self.fs.get_file_info(pafs.FileSelector(self.root)):
            if info.type == pafs.FileType.Directory:
                folders.append(info.path)
            elif wanted(info.path):
                yield _log(info)
        for folder in folders if recursive else ():
            for info in self.fs.get_file_info(pafs.FileSelector(folder, recursive=True)):
                if info.is_file and wanted(info.path):
                    yield _log(info)

    def files(self, folder: str, suffix: str) -> Iterator[pafs.FileInfo]:
        """The files with this suffix in a folder and below; none if the folder does not exist."""
        selector = pafs.FileSelector(self.file(folder), allow_not_found=True, recursive=True)
        return (info for info in self.fs.get_file_info(selector) if info.is_file and info.path.endswith(suffix))

    def read(self, path: str) -> tuple[bytes, str | None]:
        """The content of a file, and its ETag if the storage has one."""
        with self.fs.open_input_file(path) as file:
            metadata = {} if self.is_local else file.metadata() or {}
            content: bytes = file.read()
        tag = metadata.get("ETag")
        return content, None if tag is None else tag.decode().strip('"')

    def write(self, path: str, content: pa.Buffer | bytes) -> None:
        """Writes a file atomically: objects appear complete, and a local file is renamed when it is on the disk."""
        if not self.is_local:
            with self.fs.open_output_stream(path) as stream:
                stream.write(content)
            return
        folder, name = os.path.split(path)
        os.makedirs(folder, exist_ok=True)
        unfinished = f"{folder}/.{name}.{uuid.uuid4().hex}{UNFINISHED}"
        with open(unfinished, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(unfinished, path)
        entry = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(entry)
        finally:
            os.close(entry)

    def require_space(self, bytes: int) -> None:
        """Raises :class:`OSError` (``ENOSPC``) if the disk of a local folder does not have this many bytes left."""
        if not self.is_local:
            return
        os.makedirs(self.root, exist_ok=True)
        if (free := shutil.disk_usage(self.root).free) < bytes:
            raise OSError(errno.ENOSPC, f"only {free} bytes are left on the disk", self.root)

    def delete(self, path: str) -> None:
        """Deletes a file; a missing file is not an error."""
        try:
            self.fs.delete_file(path)
        except FileNotFoundError:
            pass


@contextmanager
def parquet(place: Place, path: str) -> Iterator[pq.ParquetFile]:
    """A Parquet file of a dataset.

    Raises
    ------
    DamagedError
        The file is truncated, is not Parquet, or a page of it is damaged.
    """
    try:
        with place.fs.open_input_file(path) as source, pq.ParquetFile(source, page_checksum_verification=True) as file:
            yield file
    except pa.ArrowException as error:
        raise DamagedError.of(place.shown(path), error) from error
    except OSError as error:
        # If a page cannot be decoded or has a wrong checksum, Arrow raises an OSError without an error number.
        if error.errno is not None or not place.is_local:
            raise
        raise DamagedError.of(place.shown(path), error) from error


def beside(place: Place, path: str, kind: str, of: str = "flights") -> str:
    """The file of the same shard and month in another table."""
    return place.file(kind, path.removeprefix(place.file(of) + "/"))


UNFINISHED = ".unfinished"
"""The suffix of the name of a local file during writing."""


def _log(info: pafs.FileInfo) -> Log:
    return Log(info.path, info.size, (info.mtime_ns or 0) // 1000)


def absolute(uri: str) -> str:
    """The address of a location for workers, whose working folders differ."""
    return uri if "://" in uri else str(Path(uri).resolve())


@lru_cache(maxsize=64)
def open_place(uri: str) -> Place:
    """Opens a path or an address: ``s3://``, ``gs://``, ``az://``, ``abfs://``, ``file://`` or a path.

    Raises
    ------
    FleetError
        There is no such kind of storage, or it cannot be opened.
    """
    if "://" not in uri:
        return Place(uri, pafs.LocalFileSystem(), absolute(uri), "")
    scheme = uri.partition("://")[0]
    try:
        if scheme == "az":
            fs, root = _azure(uri)
        else:
            fs, root = pafs.FileSystem.from_uri(uri)
    except (OSError, ValueError, KeyError, pa.ArrowException) as error:
        help = "places are folders and `s3://`, `gs://`, `az://`, `abfs://` addresses"
        raise FleetError(f"`{scheme}://` storage cannot be opened: {error}", help) from error
    prefix = "" if isinstance(fs, pafs.LocalFileSystem) else f"{scheme}://"
    return Place(uri, fs, root.rstrip("/"), prefix)


def _azure(uri: str) -> tuple[pafs.FileSystem, str]:
    """Opens ``az://container/path`` of the account that the usual environment variables name."""
    account = os.environ["AZURE_STORAGE_ACCOUNT"]
    fs = pafs.AzureFileSystem(account_name=account, account_key=os.environ.get("AZURE_STORAGE_KEY"))
    return fs, uri.removeprefix("az://")


def matcher(include: Iterable[str]) -> Callable[[str], bool]:
    """Returns a function that tests whether the name of a path matches one of the patterns, case-insensitively."""
    patterns = "|".join(fnmatch.translate(pattern) for pattern in include)
    compiled = re.compile(patterns, re.IGNORECASE)
    return lambda path: compiled.match(posixpath.basename(path)) is not None
