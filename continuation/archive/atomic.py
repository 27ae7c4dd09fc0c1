"""Files and locks: one-line errors, files that appear only when complete, locks that end with their process.

New data goes into ``.NAME.xxxxxxxx.part`` and reaches the disk before it is renamed. After a kill, the next writer of
the name removes the part.
"""

from __future__ import annotations

import errno
import fcntl
import glob
import os
import re
import secrets
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os import PathLike
from pathlib import Path as File
from typing import Any

from continuation.arguments.checks import complain


class ArchiveError(OSError):
    """A file that cannot be read, written or resumed; the message is one line with file and reason.

    Unprintable characters become "?", since the file may supply part of the text.
    """

    def __init__(self, message: str) -> None:
        super().__init__("".join(c if c.isprintable() else "?" for c in message))


class ArchiveExistsError(ArchiveError, FileExistsError):
    """The file exists already; archives are never overwritten."""


_ABANDONED = 60.0
"""Age in seconds at which an unlocked part is removed: writers lock theirs at once."""


@contextmanager
def beside(target: File) -> Iterator[File]:
    """A new name beside `target` to write to; a part left in the end is removed.

    Raises `ArchiveError` for errors of the operating system.
    """
    # Parts that killed writers left are only copies.
    for left in target.parent.glob(f".{glob.escape(target.name)}.{8 * '[0-9a-f]'}.part"):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > _ABANDONED and not is_held(left):
                left.unlink()
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


def publish(part: File, target: File, *, replace: bool = False) -> None:
    """Give a complete file its name in one step.

    `replace`: take the place, mode and, if allowed, owner of the old file. Raises `ArchiveExistsError` if the name is
    taken, `OSError` for other errors.
    """
    if replace and target.exists():
        status = target.stat()
        with suppress(PermissionError):
            os.chown(part, status.st_uid, status.st_gid)
        part.chmod(status.st_mode & 0o7777)
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
    # Syncs the directory too.
    with suppress(OSError):
        descriptor = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def as_file(argument: str, value: Any) -> File:
    """The path; `TypeError` if the argument is none."""
    if not isinstance(value, (str, PathLike)) or isinstance(os.fspath(value), bytes):
        raise complain(TypeError, argument, "the name of a file", value)
    return File(value)


def new_file(argument: str, value: Any) -> File:
    """The path, checked by `as_file` and `check_new`."""
    file = as_file(argument, value)
    check_new(file)
    return file


def check_new(file: File) -> None:
    """Raise `ArchiveError` if the file exists, or its directory is missing or not writable."""
    if "\0" in str(file):
        raise ArchiveError(f"{str(file)!r}: is no name for a file (it holds a NUL)")
    if os.path.lexists(file):
        raise exists(file)
    refused = {
        f"there is no directory {file.parent}": not file.parent.is_dir(),
        f"the name is too long, expected at most {_NAME_BYTES} bytes": len(file.name.encode(errors="surrogatepass"))
        > _NAME_BYTES,
        f"the directory {file.parent} may not be written": not os.access(file.parent, os.W_OK),
    }
    for what, wrong in refused.items():
        if wrong:
            raise ArchiveError(f"{file}: {what}")


_NAME_BYTES = 255 - len("..xxxxxxxx.part")
"""Linux's limit less the part's additions."""


def exists(file: File) -> ArchiveExistsError:
    """The error for an existing file."""
    return ArchiveExistsError(f"{file}: exists already, and is never overwritten; choose another name or remove it")


def short(error: BaseException) -> str:
    """The reason of an error, in the operating system's words if HDF5 quotes them."""
    text = " ".join(str(error).split())
    found = re.search(r"errno = \d+, error message = '([^']*)'", text)
    if found:
        return found[1]
    return (error.strerror if isinstance(error, OSError) and error.strerror else text)[:200]


# Open file description locks (Linux): HDF5 itself uses flock, and a POSIX lock ends when the process closes any
# descriptor of the file.
_WHOLE = struct.pack("hhlli4x", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)
_TAKEN = (errno.EAGAIN, errno.EACCES)


class Lock:
    """A lock on a file until `close` or the end of the process; `taken` is False if another process holds it.

    File systems without locks count as taken. Raises `ArchiveError` if the file is not writable.
    """

    def __init__(self, file: File) -> None:
        try:
            self.descriptor = os.open(file, os.O_RDWR | os.O_CLOEXEC | os.O_NONBLOCK)
        except OSError as error:
            raise ArchiveError(f"{file}: may not be written ({error.strerror})") from None
        self.taken = True
        try:
            if hasattr(fcntl, "F_OFD_SETLK"):
                fcntl.fcntl(self.descriptor, fcntl.F_OFD_SETLK, _WHOLE)
            else:
                fcntl.lockf(self.descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self.taken = error.errno not in _TAKEN

    def close(self) -> None:
        """Release it."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1


def is_held(file: File) -> bool:
    """Whether a process writes the file; False if unknown."""
    try:
        lock = Lock(file)
    except ArchiveError:
        return False
    lock.close()
    return not lock.taken


def own(file: File, descriptor: int, writer: Any, *, force: bool = False) -> Lock:
    """The right to replace a file; `force` ignores a live writer.

    `descriptor`: the file as it was read. `writer`: process that last wrote it. Raises `ArchiveError` if the file is
    not writable, is being written or was replaced.
    """
    # The mode too: root may write everything.
    if not os.access(file, os.W_OK) or not file.stat().st_mode & 0o222:
        raise ArchiveError(f"{file}: is read-only; copy it, or write to another file")
    if not os.access(file.parent, os.W_OK):
        raise ArchiveError(f"{file}: the directory {file.parent} may not be written; copy the file to another one")
    lock, said = Lock(file), "was replaced by another process this moment; try again"
    if not force and not lock.taken:
        said = f"process {writer or 'unknown'}, which writes it, seems to be alive; end it first, or say force=True"
    elif file.exists() and all(
        os.path.samestat(os.fstat(lock.descriptor), s) for s in (file.stat(), os.fstat(descriptor))
    ):
        return lock
    lock.close()
    raise ArchiveError(f"{file}: {said}")
