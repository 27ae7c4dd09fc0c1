"""HDF5 files that may come from anybody, as HDF5 is shown them, and what is taken out of them.

An `Image` is the file as its writer would have closed it: HDF5 itself waits without end for a checksum that a file
under SWMR does not have, and for a FIFO. A `dataset` is of the type expected, stored in the file itself, and as large
as it says: external, soft and user-defined links, virtual and external storage, and filters not ours are refused.
What is taken out of one file is counted by one `Allowance`. HDF5 2.0 checks the rest of a file's structure itself.
"""

from __future__ import annotations

import math
import os
import stat
import struct
from collections.abc import Sequence
from pathlib import Path as File
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5l, h5o, h5z

from continuation.archive.atomic import ArchiveError, short

SIGNATURE = b"\x89HDF\r\n\x1a\n"
# The superblock, versions 2 and 3: byte 8 is the version, byte 11 says whether and how a writer has the file open
# (version 3), at byte 28 there is the length that the file is to have, at byte 44 a checksum of what is before.
_VERSION, _IN_USE, _LENGTH, _CRC, HEAD_BYTES = 8, 11, 28, 44, 48
_WORD = 0xFFFFFFFF
_HEAP = b"GCOL"


class Image:
    """A file opened for reading, as it would be if its writer had closed it.

    `missing` bytes, which the file should have at its end and has not, read as zeros. `failure` is what the disk said
    when it could not be read. Raises `ArchiveError` if it is no regular file, may not be read, or is not HDF5 as far as
    its first bytes tell.
    """

    def __init__(self, file: File) -> None:
        self.descriptor, self.at, self.failure, self.closed_by_writer, self.missing = -1, 0, "", True, 0
        try:
            # Without O_NONBLOCK a FIFO would wait for somebody to write to it.
            self.descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
            status = os.fstat(self.descriptor)
            if not stat.S_ISREG(status.st_mode):
                what = "a directory" if stat.S_ISDIR(status.st_mode) else "no regular file"
                raise StructureError(f"is {what}, an archive is a file")
            self.length = status.st_size
            self._head = self._closed(os.pread(self.descriptor, HEAD_BYTES, 0))
        except FileNotFoundError:
            raise ArchiveError(f"{file}: there is no such file") from None
        except (OSError, ValueError) as error:
            self.close()
            said = str(error) if isinstance(error, StructureError) else f"cannot be read ({short(error)})"
            raise ArchiveError(f"{file}: {said}") from None

    def _closed(self, head: bytes) -> bytes:
        """The head that the file would have if its writer had closed it."""
        if not head.startswith(SIGNATURE):
            said = "is not an HDF5 file, so not an archive" if head else "is empty; its writer ended before it wrote"
            raise StructureError(said)
        padded = head.ljust(HEAD_BYTES, b"\0")
        if padded[_VERSION] not in (2, 3):
            return head
        if struct.unpack_from("<I", padded, _CRC)[0] != lookup3(padded[:_CRC]):
            raise StructureError("truncated or damaged, HDF5 cannot open it (its head is not sound)")
        self.closed_by_writer = head[_VERSION] < 3 or not head[_IN_USE]
        stated = stated_length(head)
        self.missing, self.length = max(stated - self.length, 0), max(stated, self.length)
        length = struct.pack("<Q", self.length)
        closed = head[:_IN_USE] + b"\0" + head[_IN_USE + 1 : _LENGTH] + length + head[_LENGTH + 8 : _CRC]
        return closed + struct.pack("<I", lookup3(closed))

    # -- what h5py asks for -----------------------------------------------------------------------------------

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move; the end is where it should be."""
        self.at = offset + (0, self.at, self.length)[whence]
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
        view, done = memoryview(buffer).cast("B"), 0
        try:
            while done < len(view) and (count := os.preadv(self.descriptor, [view[done:]], self.at + done)):
                done += count
        except OSError as error:
            # Its text: a traceback that is kept would keep a buffer of HDF5's.
            self.failure = short(error)
            raise
        view[done:] = bytes(len(view) - done)
        head = self._head[self.at : self.at + len(view)]
        view[: len(head)] = head
        self.at += len(view)
        if view[:4] == _HEAP:
            _check_heap(view)
        return len(view)

    def close(self) -> None:
        """Give the file back."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
        self.descriptor = -1


def stated_length(head: bytes) -> int:
    """The bytes that a file is to have, as its superblock says."""
    return int(struct.unpack_from("<Q", head, _LENGTH)[0])


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


def lookup3(head: bytes) -> int:
    """HDF5's checksum of 44 bytes of metadata: Jenkins' lookup3, `hashlittle` (burtleburtle.net/bob/c/lookup3.c)."""
    words = struct.unpack("<12I", head.ljust(48, b"\0"))
    a = b = c = 0xDEADBEEF + 44
    for k in (0, 3, 6, 9):
        a, b, c = (a + words[k]) & _WORD, (b + words[k + 1]) & _WORD, (c + words[k + 2]) & _WORD
        for shift in (4, 6, 8, 16, 19, 4) if k < 9 else ():
            # The three change places with each round, and are in their own again after six.
            a, b, c = b, (c + b) & _WORD, ((a - c) & _WORD) ^ _turned(c, shift)
    for shift in (14, 11, 25, 16, 4, 14, 24):
        a, b, c = b, ((c ^ b) - _turned(b, shift)) & _WORD, a
    return b


def _turned(x: int, k: int) -> int:
    return ((x << k) | (x >> (32 - k))) & _WORD


LEAST_BYTES = 1 << 27
"""Bytes of memory that any file may ask for. Copying takes three times as much, with numpy and scipy 500 MB in all;
with half as many a compressed path of 50,000 points is refused."""

UNFOLDING = 32
"""Times its own size that a larger file may ask for. Stored as it is, a point of two unknowns has 120 bytes or more,
and as a `Step` 1.5 KiB: 13 times as many, and twice that where it is compressed. Of zeros gzip makes a thousandth."""

COLUMN_BYTES = 1 << 14
"""Bytes of chunks that HDF5 keeps of each open dataset, so what one costs: tables are read from end to end."""

_FILTERS = {h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32, h5z.FILTER_LZF}
"""Those that h5py brings itself; any other would be a library that is loaded to read the file."""


class StructureError(ValueError):
    """Something that is in no archive; the message says what."""


class LimitError(StructureError):
    """A file that asks for more memory than it may; the message says how to let it."""


class Allowance:
    """The bytes of memory that all which is read from one file may take, in arrays and in Python's objects.

    `limit`: By default `LEAST_BYTES`, or `UNFOLDING` times the file of `size` bytes.
    """

    def __init__(self, size: int, limit: int | None = None) -> None:
        self.limit = max(LEAST_BYTES, UNFOLDING * size) if limit is None else limit
        self._taken: dict[str, int] = {}
        self._total = 0

    def take(self, what: str, claimed: int) -> None:
        """Count what is to be read; the same thing again counts once, at its latest size.

        Raises `LimitError` if all together is more than the limit.
        """
        total = self._total - self._taken.get(what, 0) + claimed
        if total > self.limit:
            raise LimitError(f"{what} claims {claimed} bytes, all of it more than the limit of {self.limit}")
        self._taken[what], self._total = claimed, total


def member(group: Any, name: str) -> Any:
    """A group or dataset in a group, by a hard link; `StructureError` if there is none."""
    raw = name.encode()
    if not group.id.links.exists(raw) or group.id.links.get_info(raw).type != h5l.TYPE_HARD:
        raise StructureError(f"it has no {name}, or a link to somewhere else")
    # As `group[name]`, which makes a new object of the whole file each time.
    found = h5o.open(group.id, raw)
    return h5py.Dataset(found) if isinstance(found, h5d.DatasetID) else h5py.Group(found)


def subgroup(group: Any, name: str) -> Any:
    """A group in a group; `StructureError` if it is anything else."""
    found = member(group, name)
    if not isinstance(found, h5py.Group):
        raise StructureError(f"{name} is no group")
    return found


def dataset(
    group: Any,
    name: str,
    kind: np.dtype[Any] | None,
    shape: Sequence[int | None] | None,
    allowance: Allowance,
    rows: int | None = None,
) -> Any:
    """A dataset in a group, its storage checked, and what is to be read of it counted: all, or its first `rows`.

    Without a `kind` it holds any numbers; a length of None may be any. Raises `StructureError` if it is something else,
    has fewer rows, or claims more than what is left of the allowance.
    """
    found = member(group, name)
    if not isinstance(found, h5py.Dataset):
        raise StructureError(f"{name} is no dataset")
    stored, lengths, properties = found.dtype, found.shape or (), found.id.get_create_plist()
    filters = [properties.get_filter(k)[0] for k in range(properties.get_nfilters())]
    chunk = properties.get_chunk() if properties.get_layout() == h5d.CHUNKED else (0,)
    shaped = shape is None or (len(lengths) == len(shape) and all(n in (None, m) for n, m in zip(shape, lengths)))
    texts = kind is not None and kind.kind == stored.kind == "S" and stored.itemsize == kind.itemsize
    typed = stored.kind in "fiubc" if kind is None else texts or stored == kind
    refused = {
        f"holds {stored}, expected {kind or 'numbers'}": not typed,
        f"has the shape {found.shape}, expected {shape}": not shaped or found.shape is None,
        "is stored outside of the file": properties.get_layout() == h5d.VIRTUAL or properties.get_external_count(),
        f"is stored by a filter of {filters}, which h5py does not bring itself": not set(filters) <= _FILTERS,
        "has fewer rows than were committed": rows is not None and (not lengths or lengths[0] < rows),
    }
    for what, wrong in refused.items():
        if wrong:
            raise StructureError(f"{name} {what}")
    # A chunk is unfolded whole, and each of two filters makes a copy of it.
    if 4 * math.prod(chunk) * stored.itemsize > allowance.limit:
        raise LimitError(f"{name} is stored in chunks of {chunk}, more than the limit of {allowance.limit}")
    read = lengths if rows is None else (rows, *lengths[1:])
    allowance.take(f"{group.name}/{name}".lstrip("/"), stored.itemsize * math.prod(read))
    return found
