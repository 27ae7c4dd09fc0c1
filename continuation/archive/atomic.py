"""Files and locks.

New data is written as ``.NAME.xxxxxxxx.part``, then renamed.
"""

from __future__ import annotations

import errno
import fcntl
import os
import re
import secrets
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os import PathLike
from pathlib import Path as File
from typing import Any

from continuation.arguments.checks import expect


class ArchiveError(OSError):
    """A file that cannot be read, written or resumed. Unprintable characters of the message become "?"."""

    def __init__(self, message: str) -> None:
        super().__init__("".join(c if c.isprintable() else "?" for c in message))


class ArchiveExistsError(ArchiveError, FileExistsError):
    """The file exists; archives are never overwritten."""


@contextmanager
def beside(target: File) -> Iterator[File]:
    """A new name beside `target`; the file is removed in the end."""
    part = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        yield part
    except ArchiveError as error:
        raise type(error)(str(error).replace(str(part), str(target))) from error
    except (OSError, RuntimeError) as error:
        raise ArchiveError(f"{target}: could not be written ({short(error)})") from error
    finally:
        with suppress(OSError):
            part.unlink()


def publish(part: File, target: File, *, replace: bool = False, descriptor: int = -1) -> None:
    """Rename a complete file, once it is on disk; `replace` keeps the old file's mode.

    `descriptor`: of an open, locked file; closing another ends POSIX locks. Raises `ArchiveExistsError` if the name is
    taken.
    """
    if descriptor >= 0:
        os.fsync(descriptor)
    else:
        with part.open("rb") as written:
            os.fsync(written.fileno())
    if replace and target.exists():
        part.chmod(target.stat().st_mode & 0o7777)
    try:
        (os.replace if replace else os.link)(part, target)
    except FileExistsError:
        raise exists(target) from None
    except OSError as error:
        if replace or error.errno not in (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS):
            raise
        # Without hard links, this reserves the name.
        os.close(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
        os.replace(part, target)


def as_file(argument: str, value: Any) -> File:
    """The path; `TypeError` otherwise."""
    named = isinstance(value, (str, PathLike)) and not isinstance(os.fspath(value), bytes)
    expect(named, argument, "the name of a file", value, TypeError)
    return File(value)


def new_file(argument: str, value: Any) -> File:
    """Path of a new file."""
    return check_new(as_file(argument, value))


def check_new(file: File) -> File:
    """The file; `ArchiveError` unless it can be made."""
    if os.path.lexists(file):
        raise exists(file)
    said = (
        "is no name for a file (it holds a NUL)"
        if "\0" in str(file)
        else f"there is no directory {file.parent}"
        if not file.parent.is_dir()
        else f"the directory {file.parent} may not be written"
        if not os.access(file.parent, os.W_OK)
        else ""
    )
    if said:
        raise ArchiveError(f"{file}: {said}")
    return file


def exists(file: File) -> ArchiveExistsError:
    """Error for an existing file."""
    return ArchiveExistsError(f"{file}: exists already, and is never overwritten; choose another name or remove it")


def short(error: BaseException) -> str:
    """The error's reason, as the operating system gives it."""
    text = " ".join(str(error).split())
    found = re.search(r"errno = \d+, error message = '([^']*)'", text)
    if found:
        return found[1]
    return (error.strerror if isinstance(error, OSError) and error.strerror else text)[:200]


# HDF5 uses flock, and POSIX locks end when any descriptor is closed.
_WHOLE = struct.pack("hhlli4x", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)
_TAKEN = (errno.EAGAIN, errno.EACCES)


def _lock(descriptor: int) -> None:
    try:
        fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, _WHOLE)
    except (AttributeError, OSError) as error:
        if getattr(error, "errno", None) in _TAKEN:
            raise
        # Neither macOS nor gVisor has it.
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


class Lock:
    """A lock on a file until `close` or the process ends; `taken` is False if another process holds it.

    File systems without locks grant it. Raises `ArchiveError` if the file is not writable.
    """

    def __init__(self, file: File) -> None:
        try:
            self.descriptor = os.open(file, os.O_RDWR | os.O_CLOEXEC | os.O_NONBLOCK)
        except OSError as error:
            raise ArchiveError(f"{file}: may not be written ({error.strerror})") from None
        self.taken = True
        try:
            _lock(self.descriptor)
        except OSError as error:
            self.taken = error.errno not in _TAKEN

    def close(self) -> None:
        """Release it."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1


def is_held(file: File) -> bool:
    """Whether a process is known to write the file."""
    try:
        lock = Lock(file)
    except ArchiveError:
        return False
    lock.close()
    return not lock.taken


def own(file: File, descriptor: int) -> Lock:
    """Lock a file, open as `descriptor`, to replace it.

    Raises `ArchiveError` if the file is not writable, being written, or replaced.
    """
    # The mode too: root may write everything.
    if not file.stat().st_mode & 0o222:
        raise ArchiveError(f"{file}: is read-only; copy it, or write to another file")
    lock = Lock(file)
    if (
        lock.taken
        and file.exists()
        and all(os.path.samestat(os.fstat(lock.descriptor), status) for status in (file.stat(), os.fstat(descriptor)))
    ):
        return lock
    lock.close()
    raise ArchiveError(f"{file}: is being written by another process, or was replaced by it; end it first")
