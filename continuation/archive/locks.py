"""The right to write a file: a lock that dies with its owner, whatever becomes of the number of its process."""

from __future__ import annotations

import errno
import fcntl
import os
import struct
import weakref
from pathlib import Path as File

from continuation.archive.errors import ArchiveError

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
            self._descriptor = os.open(file, os.O_RDWR | os.O_CLOEXEC | os.O_NONBLOCK)
        except OSError as error:
            raise ArchiveError(f"{file}: may not be written ({error.strerror})") from None
        self.taken = True
        try:
            if hasattr(fcntl, "F_OFD_SETLK"):
                fcntl.fcntl(self._descriptor, fcntl.F_OFD_SETLK, _WHOLE)
            else:
                fcntl.lockf(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self.taken = error.errno not in _TAKEN
        _HELD.add(self)

    def same(self, file: File, descriptor: int) -> bool:
        """Whether the name, the file that was read and the file that is locked are one."""
        mine = os.fstat(self._descriptor)
        try:
            return os.path.samestat(mine, file.stat()) and os.path.samestat(mine, os.fstat(descriptor))
        except OSError:
            return False

    def sync(self) -> None:
        """Wait until the file is on the disk."""
        os.fsync(self._descriptor)

    def close(self) -> None:
        """Give it back; a second call does nothing."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


_HELD: weakref.WeakSet[Lock] = weakref.WeakSet()


def _in_child() -> None:
    """A forked child shares its parent's locks, and would keep them when the parent is gone."""
    for lock in list(_HELD):
        lock.close()


os.register_at_fork(after_in_child=_in_child)


def is_held(file: File) -> bool:
    """Whether some process writes the file; False also where that cannot be asked."""
    try:
        lock = Lock(file)
    except ArchiveError:
        return False
    lock.close()
    return not lock.taken


def locked(file: File, descriptor: int, writer: str, *, force: bool = False) -> Lock:
    """The lock on a file that is to be replaced; by force also where another has it.

    `descriptor` is of the file as it was read, `writer` who wrote it last. Raises `ArchiveError` if its writer is at
    work, or the file was replaced this very moment.
    """
    lock = Lock(file)
    if not force and not lock.taken:
        lock.close()
        raise ArchiveError(f"{file}: {writer}, which writes it, seems to be alive; end it first, or say force=True")
    if not lock.same(file, descriptor):
        lock.close()
        raise ArchiveError(f"{file}: was replaced by another process this moment; try again")
    return lock
