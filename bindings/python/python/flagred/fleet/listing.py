"""Logs in local folders: each file once, regardless of the number of its names and links."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterator

from .errors import FleetError
from .storage import Log

__all__ = ["Listing"]


class Listing:
    """Lists the folders of a run in sequence.

    Links to folders are not followed. A link to a file counts if the file is not listed by its own name.

    Parameters
    ----------
    recursive
        Whether to list subfolders too.
    wanted
        Whether a path has the name of a log.
    is_listed
        Whether a path, if it exists, is a log in one of the folders of the run.
    """

    def __init__(self, recursive: bool, wanted: Callable[[str], bool], is_listed: Callable[[str], bool]) -> None:
        self._recursive = recursive
        self._wanted = wanted
        self._is_listed = is_listed
        self._linked: set[tuple[int, int]] = set()
        self.passed_over = 0
        """Names of logs that cannot be read: not UTF-8, or of a FIFO, a device, a socket or a broken link."""

    def logs(self, root: str) -> Iterator[Log]:
        """The logs in a folder, or the log with this path.

        Raises
        ------
        FleetError
            There is no such folder.
        OSError
            A folder cannot be listed.
        """
        if not _is_utf8(root):
            shown = os.fsencode(root).decode(errors="backslashreplace")
            raise FleetError(f"the name of `{shown}` is not UTF-8", f"rename the {'folder' if os.path.isdir(root) else 'file'}")
        try:
            found = os.stat(root)
        except FileNotFoundError as error:
            raise FleetError(f"there is no `{root}`", "the folder must exist") from error
        if stat.S_ISREG(found.st_mode):
            if found.st_nlink == 1 or self._is_new(found):
                yield _log(root, found)
        elif stat.S_ISDIR(found.st_mode):
            yield from self._folder(root)
        else:
            raise FleetError(f"`{root}` is neither a folder nor a file", "give a folder of logs")

    def _folder(self, folder: str) -> Iterator[Log]:
        with os.scandir(folder) as entries:
            names = sorted(entries, key=lambda entry: entry.name)
        for entry in names:
            is_utf8 = _is_utf8(entry.name)
            if entry.is_dir(follow_symlinks=False):
                if self._recursive and is_utf8:
                    yield from self._folder(entry.path)
                elif self._recursive:
                    self.passed_over += 1
                continue
            if not self._wanted(entry.path):
                continue
            try:
                found = os.stat(entry.path)
            except FileNotFoundError:
                # A broken link is counted; a file that was deleted meanwhile is ignored.
                self.passed_over += entry.is_symlink()
                continue
            if stat.S_ISDIR(found.st_mode):
                continue
            if not is_utf8 or not stat.S_ISREG(found.st_mode):
                self.passed_over += 1
            elif self._is_first(entry, found):
                yield _log(entry.path, found)

    def _is_first(self, entry: os.DirEntry[str], found: os.stat_result) -> bool:
        """Whether no other name of the file is listed."""
        if entry.is_symlink() and self._is_listed(os.path.realpath(entry.path)):
            return False
        if not entry.is_symlink() and found.st_nlink == 1:
            return True
        return self._is_new(found)

    def _is_new(self, found: os.stat_result) -> bool:
        """Whether a file with several names was not listed yet."""
        file = (found.st_dev, found.st_ino)
        is_new = file not in self._linked
        self._linked.add(file)
        return is_new


def _is_utf8(name: str) -> bool:
    """Whether a name is valid UTF-8. Python represents invalid bytes as surrogates."""
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True


def _log(path: str, found: os.stat_result) -> Log:
    return Log(path, found.st_size, found.st_mtime_ns // 1000)
