"""Files as HDF5 is shown them: bytes that are read here, so that no fault of theirs is HDF5's to bear.

HDF5 waits without end for a checksum that a file under SWMR does not have, and for a FIFO. Neither can happen where
Python reads in its stead.
"""

from __future__ import annotations

import os
import resource
import stat
import struct
from pathlib import Path as File

from continuation.archive.atomic import short
from continuation.archive.errors import ArchiveError

SIGNATURE = b"\x89HDF\r\n\x1a\n"
# The superblock, versions 2 and 3: byte 8 is the version, byte 11 says whether and how a writer has the file open
# (version 3), at byte 28 there is the length that the file is to have, at byte 44 a checksum of what is before.
_VERSION, _IN_USE, _LENGTH, _CRC, HEAD_BYTES = 8, 11, 28, 44, 48
_SWMR = 4
_WORD = 0xFFFFFFFF
_HEAP = b"GCOL"


class Image:
    """A file opened for reading, as it would be if its writer had closed it.

    `missing` bytes, which the file should have at its end and has not, read as zeros. `failure` is what the disk said
    when it could not be read. Raises `ArchiveError` if it is no
    regular file, may not be read, or is not HDF5 as far as its first bytes tell.
    """

    def __init__(self, file: File) -> None:
        self.file, self.at = file, 0
        self.failure = ""
        self.descriptor = _opened(file)
        try:
            self._begin()
        except BaseException:
            os.close(self.descriptor)
            raise

    def _begin(self) -> None:
        try:
            head = os.pread(self.descriptor, HEAD_BYTES, 0)
        except OSError as error:
            raise ArchiveError(f"{self.file}: could not be read ({short(error)})") from error
        size = os.fstat(self.descriptor).st_size
        _check(self.file, head)
        self.closed_by_writer, self.missing, self.length = True, 0, size
        if head[_VERSION] in (2, 3):
            length = stated_length(head)
            if struct.unpack_from("<I", head, _CRC)[0] != lookup3(head[:_CRC]):
                raise ArchiveError(f"{self.file}: truncated or damaged, HDF5 cannot open it (its head is not sound)")
            self.closed_by_writer = head[_VERSION] < 3 or not head[_IN_USE]
            self.under_swmr = bool(head[_IN_USE] & _SWMR)
            self.missing, self.length = max(length - size, 0), max(length, size)
            closed = head[:_IN_USE] + b"\0" + head[_IN_USE + 1 : _LENGTH] + struct.pack("<Q", self.length)
            closed += head[_LENGTH + 8 : _CRC]
            head = closed + struct.pack("<I", lookup3(closed))
        self._head = head

    # -- what h5py asks for -----------------------------------------------------------------------------------

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move; the end is where it should be."""
        self.at = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self.at, os.SEEK_END: self.length}[whence]
        return self.at

    def tell(self) -> int:
        """Where it is."""
        return self.at

    def read(self, size: int) -> bytes:
        """So many bytes; h5py knows a file by this method, and uses `readinto`."""
        buffer = bytearray(size)
        self.readinto(buffer)
        return bytes(buffer)

    def readinto(self, buffer: bytearray) -> int:
        """Fill the buffer."""
        view = memoryview(buffer).cast("B")
        done = 0
        while done < len(view):
            try:
                count = os.preadv(self.descriptor, [view[done:]], self.at + done)
            except OSError as error:
                # Its text: a traceback that is kept would keep a buffer of HDF5's.
                self.failure = short(error)
                raise
            if not count:
                view[done:] = bytes(len(view) - done)
                break
            done += count
        if self.at < len(self._head):
            count = min(len(self._head) - self.at, len(view))
            view[:count] = self._head[self.at : self.at + count]
        self.at += len(view)
        if view[:4] == _HEAP:
            _check_heap(view)
        return len(view)

    def close(self) -> None:
        """Give the file back."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1


def to_nowhere(descriptor: int) -> None:
    """Let the descriptor of a file stand for another file, which is thrown away."""
    # A file in memory has no end to run into; but a limit on files counts for it too, and not for the null device.
    limited = resource.getrlimit(resource.RLIMIT_FSIZE)[0] != resource.RLIM_INFINITY
    if limited or not hasattr(os, "memfd_create"):
        nowhere = os.open(os.devnull, os.O_RDWR)
    else:
        nowhere = os.memfd_create("abandoned")
    os.dup2(nowhere, descriptor, inheritable=False)
    os.close(nowhere)


def stated_length(head: bytes) -> int:
    """The bytes that a file is to have, as its superblock says."""
    return int(struct.unpack_from("<Q", head, _LENGTH)[0])


def _opened(file: File) -> int:
    try:
        # Without O_NONBLOCK a FIFO would wait for somebody to write to it.
        descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except FileNotFoundError:
        raise ArchiveError(f"{file}: there is no such file") from None
    except PermissionError:
        raise ArchiveError(f"{file}: may not be read (permissions)") from None
    except (OSError, ValueError) as error:
        raise ArchiveError(f"{file}: cannot be opened ({short(error)})") from None
    mode = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        what = "a directory" if stat.S_ISDIR(mode) else "no regular file"
        raise ArchiveError(f"{file}: is {what}, an archive is a file")
    return descriptor


def _check(file: File, head: bytes) -> None:
    if not head:
        raise ArchiveError(f"{file}: is empty; its writer ended before anything was written")
    if not head.startswith(SIGNATURE):
        raise ArchiveError(f"{file}: is not an HDF5 file, so not an archive")
    if len(head) < HEAD_BYTES:
        raise ArchiveError(f"{file}: truncated, only its first {len(head)} bytes are there")


def _check_heap(heap: memoryview) -> None:
    """Whether the objects of a global heap, which has no checksum, fill it: in one of zeros HDF5 loops without end.

    Raises `OSError` if they do not.
    """
    (size,) = struct.unpack_from("<Q", heap, 8)
    at = 16
    while size <= len(heap) and size - at >= 16:
        index, length = struct.unpack_from("<H6xQ", heap, at)
        # The object number 0 is the space that is free, its own head included.
        at += length if not index else 16 + (length + 7) // 8 * 8
        if at > size or (not index and at != size):
            raise OSError("a heap of texts is not sound")


def lookup3(data: bytes) -> int:
    """The checksum of HDF5's metadata: Jenkins' lookup3, `hashlittle` (burtleburtle.net/bob/c/lookup3.c)."""
    a = b = c = (0xDEADBEEF + len(data)) & _WORD
    blocks = max((len(data) - 1) // 12, 0)
    for k in range(blocks):
        x, y, z = struct.unpack_from("<III", data, 12 * k)
        a, b, c = (a + x) & _WORD, (b + y) & _WORD, (c + z) & _WORD
        for shift in (4, 6, 8, 16, 19, 4):
            # The three change places with each round, and are in their own again after six.
            a, b, c = b, (c + b) & _WORD, ((a - c) & _WORD) ^ _turned(c, shift)
    x, y, z = struct.unpack("<III", data[12 * blocks :].ljust(12, b"\0"))
    a, b, c = (a + x) & _WORD, (b + y) & _WORD, (c + z) & _WORD
    for shift in (14, 11, 25, 16, 4, 14, 24):
        c = ((c ^ b) - _turned(b, shift)) & _WORD
        a, b, c = b, c, a
    return int(b)


def _turned(x: int, k: int) -> int:
    return ((x << k) | (x >> (32 - k))) & _WORD
