"""Files and who may write them: errors in one line, names that appear whole, locks that die with their owner.

A file is written beside its name, brought to the disk, then named.

What is written beside is called ``.NAME.xxxxxxxx.part``; a kill may leave it, and the next writer of
that name removes it.
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
    """A file that cannot be read, written or resumed; the message is one line that names the file and the reason.

    What the file itself says is in it, so that what cannot be printed, as a terminal's control codes, is a "?".
    """

    def __init__(self, message: str) -> None:
        super().__init__("".join(c if c.isprintable() else "?" for c in message))


class ArchiveExistsError(ArchiveError, FileExistsError):
    """The file to be written exists already; an archive is never overwritten."""


_ABANDONED = 60.0
"""Seconds after which a part that nobody holds a lock on is litter: it is locked right after it is made."""


@contextmanager
def beside(target: File) -> Iterator[File]:
    """A new name beside `target`, to be written and then published; what is left under it in the end is removed.

    Raises `ArchiveError` for whatever the operating system says while it is written.
    """
    # What killed writers of the same name left was never anything but a copy.
    for left in target.parent.glob(f".{glob.escape(target.name)}.{8 * '[0-9a-f]'}.part"):
        with suppress(OSError):
            if time.time() - left.stat().st_mtime > _ABANDONED and not is_held(left):
                left.unlink()
    part = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        yield part
    except ArchiveError as error:
        # The name that people know.
        raise type(error)(str(error).replace(str(part), str(target))) from error
    except (OSError, RuntimeError) as error:
        raise ArchiveError(f"{target}: could not be written ({short(error)})") from error
    finally:
        with suppress(OSError):
            part.unlink()


def publish(part: File, target: File, *, replace: bool = False) -> None:
    """Give a complete file its name in the same directory, in one step.

    `replace`: It takes the place of an old file, whose mode it gets, and whose owner where that is allowed. Raises
    `ArchiveExistsError` if there is one and it is not to be replaced, `OSError` for anything else.
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
        # A file system without links: the name is taken first, so that nobody else can.
        os.close(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
        os.replace(part, target)
    # The names too come to the disk, where the file system can do it.
    with suppress(OSError):
        descriptor = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def as_file(argument: str, value: Any) -> File:
    """The path that an argument is; `TypeError` if it is no name of a file."""
    if not isinstance(value, (str, PathLike)) or isinstance(os.fspath(value), bytes):
        raise complain(TypeError, argument, "the name of a file", value)
    return File(value)


def new_file(argument: str, value: Any) -> File:
    """The path that an argument is, of a file that can be made; see `as_file`, `check_new`."""
    file = as_file(argument, value)
    check_new(file)
    return file


def check_new(file: File) -> None:
    """Whether a file can be made there, asked before any work is done.

    Raises `ArchiveError` if it exists, or its directory does not, or may not be written.
    """
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
"""Linux' limit, less what the name of a part adds."""


def exists(file: File) -> ArchiveExistsError:
    """The error for a file that is there already."""
    return ArchiveExistsError(f"{file}: exists already, and is never overwritten; choose another name or remove it")


def short(error: BaseException) -> str:
    """The reason of an error, with the operating system's own words where HDF5 has buried them."""
    text = " ".join(str(error).split())
    found = re.search(r"errno = \d+, error message = '([^']*)'", text)
    if found:
        return found[1]
    return (error.strerror if isinstance(error, OSError) and error.strerror else text)[:200]


# Locks of an open file description (Linux): flock is taken by HDF5 for its own ends, and the locks of POSIX, which
# serve elsewhere, are lost when any descriptor of the file is closed by the process, as by one who reads it.
_WHOLE = struct.pack("hhlli4x", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)
_TAKEN = (errno.EAGAIN, errno.EACCES)


class Lock:
    """A lock on a file, held until `close`, or until the process is gone; `taken` is False where somebody else has it.

    Where the file system knows no locks it counts as taken. Raises `ArchiveError` if the file cannot be opened for
    writing.
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
        """Give it back; a second call does nothing."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1


def is_held(file: File) -> bool:
    """Whether some process writes the file; False also where that cannot be asked."""
    try:
        lock = Lock(file)
    except ArchiveError:
        return False
    lock.close()
    return not lock.taken


def own(file: File, descriptor: int, writer: Any, *, force: bool = False) -> Lock:
    """The right to replace a file (no link to it); by force also if its writer seems to be at work.

    `descriptor` is of the file as it was read, `writer` the number of the process that wrote it last. Raises
    `ArchiveError` if it may not be written, is being written, or was replaced since it was opened.
    """
    # The mode too, since root may write everything: who took the right away meant it.
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
        # The name, the file that was read and the file that is locked are one.
        return lock
    lock.close()
    raise ArchiveError(f"{file}: {said}")
