"""Checked HDF5: a file driver for untrusted files, datasets of checked type, storage and size, checksums of rows.

HDF5 itself hangs at FIFOs and at checksums that SWMR omits. Links, external storage and foreign filters are refused.

A block is one commit's rows. Its row in ``/checks`` holds its end and a checksum of each column. A commit writes two
records, *intent* and *commit*, each in two alternating places. A kill damages at most one record; the other three
determine it.
"""

from __future__ import annotations

import math
import os
import stat
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path as File
from typing import Any, Literal

import h5py
import numpy as np
from attrs import astuple, frozen
from h5py import h5d, h5l, h5o, h5z

from continuation.archive.atomic import ArchiveError, short

Array = np.ndarray[Any, Any]

GROUP = "checks"
RECORDS = "commits"
PLACES = 2
"""Alternating places of records and checkpoints."""

RECORD = struct.Struct("<7QI")
"""A `Committed` with its CRC-32."""

_BOUNDS = struct.Struct("<QQ")

_LARGE = 1 << 16
"""Bytes from which the checksum is that of row and column sums: CRC-32 runs at 2.7 GB/s, sums at 40 GB/s."""


class DamageError(ValueError):
    """Data differ from those written."""


@frozen
class Committed:
    """What a file holds after a commit: numbers of rows, of blocks and of event names, and the last checkpoint."""

    sequence: int = 0
    points: int = 0
    paths: int = 0
    point_blocks: int = 0
    path_blocks: int = 0
    names: int = 0
    checkpoint: int = 0

    def rows(self, table: str) -> int:
        """Rows of ``"point"`` or ``"path"``."""
        return self.points if table == "point" else self.paths

    def pack(self) -> Array:
        """Bytes, with a CRC-32."""
        body = RECORD.pack(*astuple(self), 0)[:-4]
        return np.frombuffer(body + struct.pack("<I", zlib.crc32(body)), "u1")


def blank() -> Array:
    """Records of a new file, shape (4, bytes): intents, then commits."""
    return np.array([Committed(sequence=k % PLACES).pack() for k in range(2 * PLACES)])


def latest(records: Array) -> Committed:
    """The last complete commit."""
    read = [(zlib.crc32(raw[:-4]), *RECORD.unpack(raw)) for raw in records]
    found = [Committed(*numbers) if crc == stored else None for crc, *numbers, stored in read]
    commits = [one for one in found[PLACES:] if one is not None]
    last = max(commits, key=lambda one: one.sequence, default=None)
    if last is not None and len(commits) < PLACES:
        # The intent shows whether a later commit had begun.
        intent = found[(last.sequence + 1) % PLACES]
        last = None if intent is None else max(last, intent, key=lambda one: one.sequence)
    if last is None:
        raise DamageError("the records of what was committed are damaged")
    return last


def digest(values: Any, seed: int = 0) -> int:
    """CRC-32 of an array, or of the row and column sums of a large matrix."""
    whole: Any = np.ascontiguousarray(values)
    if whole.ndim == 2 and whole.nbytes >= _LARGE and whole.itemsize == 8:
        words = whole.view("u8")
        return zlib.crc32(np.add.reduce(words, axis=1), zlib.crc32(np.add.reduce(words, axis=0), seed))
    return zlib.crc32(whole, seed)


def seal(block: Mapping[str, Array], start: int) -> Array:
    """The checksums of a block that begins at row `start`."""
    stop = start + len(next(iter(block.values())))
    seed = zlib.crc32(_BOUNDS.pack(start, stop))
    sums = [digest(block[name], seed) for name in sorted(block)]
    return np.array([stop & 0xFFFFFFFF, stop >> 32, *sums], dtype="u4")


class Ledger:
    """Checksums of a table's first `rows` rows by block, up to the first impossible one."""

    def __init__(self, sums: Array, columns: Sequence[str], rows: int) -> None:
        bounds = np.concatenate(([0], np.ascontiguousarray(sums[:, :2]).view("<i8").ravel()))
        wrong = np.flatnonzero((bounds[1:] <= bounds[:-1]) | (bounds[1:] > rows))
        self.bounds = bounds[: wrong[0] + 1] if wrong.size else bounds
        self.rows = int(self.bounds[-1])
        self._sums, self._place = sums[:, 2:], {name: k for k, name in enumerate(sorted(columns))}

    def read(self, name: str, rows: slice, fetch: Callable[[slice], Array]) -> Array:
        """Rows of a column, checked; `fetch` reads whole blocks."""
        if rows.stop <= rows.start:
            return fetch(rows)
        first, last = (int(k) for k in np.searchsorted(self.bounds, (rows.start + 1, rows.stop)))
        edges, bad = self.bounds[first - 1 : last + 1].tolist(), []
        values = fetch(slice(edges[0], edges[-1]))
        for k, (start, stop) in enumerate(pairwise(edges), first - 1):
            seed = zlib.crc32(_BOUNDS.pack(start, stop))
            if digest(values[start - edges[0] : stop - edges[0]], seed) != self._sums[k, self._place[name]]:
                bad.append((start, stop))
        if bad:
            spans = ", ".join(f"{start} to {stop - 1}" for start, stop in bad[:4]) + (", ..." if len(bad) > 4 else "")
            sound = len(values) - sum(stop - start for start, stop in bad)
            raise DamageError(f"rows {spans} of {name} are not what was written; the other {sound} rows read are sound")
        return values[rows.start - edges[0] : rows.stop - edges[0]]


def of_attributes(attributes: Mapping[str, Any]) -> int:
    """A checksum of names and values."""
    crc = 0
    for name in sorted(attributes):
        value = attributes[name]
        text = value.encode(errors="surrogateescape") if isinstance(value, str) else np.asarray(value).tobytes()
        crc = zlib.crc32(text, zlib.crc32(name.encode(errors="surrogateescape"), crc))
    return crc


PROBLEM = "problem"
SIGNATURE = b"\x89HDF\r\n\x1a\n"
_SUPERBLOCK = struct.Struct("<8s4B4QI")
"""Signature, version (2 or 3), two sizes, a writer's flags, base, extension, length, root, checksum."""


class Image:
    """A file opened for reading, as if its writer had closed it.

    `missing`: bytes cut off, read as zeros. `failure`: the disk's error. Raises `ArchiveError` unless it is a readable
    HDF5 file.
    """

    def __init__(self, file: File) -> None:
        self.descriptor, self.at, self.failure, self.closed_by_writer, self.missing = -1, 0, "", True, 0
        try:
            # Without O_NONBLOCK a FIFO would block.
            self.descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
            status = os.fstat(self.descriptor)
            if not stat.S_ISREG(status.st_mode):
                raise StructureError("is no regular file")
            self.length = status.st_size
            self._head = self._closed(os.pread(self.descriptor, _SUPERBLOCK.size, 0))
        except (OSError, ValueError) as error:
            self.close()
            said = str(error) if isinstance(error, StructureError) else f"cannot be read ({short(error)})"
            raise ArchiveError(f"{file}: {said}") from None

    def _closed(self, head: bytes) -> bytes:
        """The superblock as its writer would have left it."""
        if not head.startswith(SIGNATURE):
            said = "is not an HDF5 file, so not an archive" if head else "is empty; its writer ended before it wrote"
            raise StructureError(said)
        signature, version, *sizes, used, base, more, stated, root, checksum = _SUPERBLOCK.unpack(head.ljust(48))
        if version not in (2, 3):
            return head
        self.closed_by_writer = version == 2 or not used
        if self.closed_by_writer and stated == self.length:
            return head
        if checksum != lookup3(head[:-4]):
            raise StructureError("truncated or damaged, HDF5 cannot open it (its head is not sound)")
        self.missing, self.length = max(stated - self.length, 0), max(stated, self.length)
        closed = _SUPERBLOCK.pack(signature, version, *sizes, 0, base, more, self.length, root, 0)[:-4]
        return closed + struct.pack("<I", lookup3(closed))

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to a byte."""
        self.at = offset + (0, self.at, self.length)[whence]
        return self.at

    def tell(self) -> int:
        """The current byte."""
        return self.at

    def read(self, size: int) -> bytes:
        """The next bytes, zeros beyond the end."""
        raw = self._head[self.at : self.at + size]
        try:
            while len(raw) < size and (more := os.pread(self.descriptor, size - len(raw), self.at + len(raw))):
                raw += more
        except OSError as error:
            self.failure = short(error)
            raise
        self.at += size
        if raw.startswith(b"GCOL"):
            _check_heap(raw)
        return raw.ljust(size, b"\0")

    def close(self) -> None:
        """Close the file."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
        self.descriptor = -1


def _check_heap(heap: bytes) -> None:
    """Raise `OSError` unless objects fill the global heap: HDF5 never ends in a heap of zeros."""
    (size,) = struct.unpack_from("<Q", heap, 8)
    at = 16
    while size <= len(heap) and size - at >= 16:
        index, length = struct.unpack_from("<H6xQ", heap, at)
        # Object 0 is free space with its head.
        at += length if not index else 16 + (length + 7) // 8 * 8
        if at > size or (not index and at != size):
            raise OSError("a heap of texts is not sound")


def lookup3(head: bytes) -> int:
    """HDF5's checksum of 44 bytes: Jenkins' lookup3, `hashlittle` (burtleburtle.net/bob/c/lookup3.c)."""
    words = struct.unpack("<12I", head.ljust(48, b"\0"))
    a = b = c = 0xDEADBEEF + 44
    for k in (0, 3, 6, 9):
        a, b, c = a + words[k], b + words[k + 1], c + words[k + 2]
        for shift in (4, 6, 8, 16, 19, 4) if k < 9 else ():
            # a, b, c rotate, and return after six rounds.
            a, b, c = b, c + b, (a - c) ^ _turned(c, shift)
    for shift in (14, 11, 25, 16, 4, 14, 24):
        a, b, c = b, (c ^ b) - _turned(b, shift), a
    return b % (1 << 32)


def _turned(x: int, k: int) -> int:
    """The lower 32 bits, rotated; beyond them nothing is read."""
    x %= 1 << 32
    return (x << k) | (x >> (32 - k))


LEAST_BYTES = 1 << 27
"""Bytes of memory for any file: copying takes three times its size; half would refuse a compressed path of 50,000
points."""

UNFOLDING = 32
"""Memory over size of a larger file: a point of two unknowns takes 120 bytes, its `Step` 1.5 KiB, twice that if
compressed."""

_FILTERS = {h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32, h5z.FILTER_LZF}
"""h5py's own filters; others would load a library."""


class StructureError(ValueError):
    """The file holds something that no archive contains."""


class LimitError(StructureError):
    """The file needs more memory than its limit."""


class Allowance:
    """Memory that one file may take.

    `limit`: default `UNFOLDING` times `size`, at least `LEAST_BYTES`.
    """

    def __init__(self, size: int, limit: int | None = None) -> None:
        self.limit = max(LEAST_BYTES, UNFOLDING * size) if limit is None else limit
        self._taken: dict[str, int] = {}
        self._total = 0

    def take(self, what: str, claimed: int) -> None:
        """Count memory; a repeated item counts once."""
        total = self._total - self._taken.get(what, 0) + claimed
        if total > self.limit:
            raise LimitError(f"{what} claims {claimed} bytes, all of it more than the limit of {self.limit}")
        self._taken[what], self._total = claimed, total


def member(group: Any, name: str) -> Any:
    """A group or dataset behind hard links; `name` may be a path."""
    found = group.id
    for part in name.encode().split(b"/"):
        if not found.links.exists(part) or found.links.get_info(part).type != h5l.TYPE_HARD:
            raise StructureError(f"it has no {name}, or a link to somewhere else")
        # `group[name]` would reopen the file.
        found = h5o.open(found, part)
    return h5py.Dataset(found) if isinstance(found, h5d.DatasetID) else h5py.Group(found)


def subgroup(group: Any, name: str) -> Any:
    """A group in a group."""
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
    """A checked dataset; `rows` rows (default: all) count in the allowance.

    A `kind` None admits any numbers, a length None any length.
    """
    found = member(group, name)
    if not isinstance(found, h5py.Dataset):
        raise StructureError(f"{name} is no dataset")
    stored, lengths, properties = found.id.dtype, found.id.shape or (), found.id.get_create_plist()
    kept = properties.get_layout()
    filters = [properties.get_filter(k)[0] for k in range(properties.get_nfilters())]
    chunk = properties.get_chunk() if kept == h5d.CHUNKED else (0,)
    shaped = shape is None or (len(lengths) == len(shape) and all(n in (None, m) for n, m in zip(shape, lengths)))
    texts = kind is not None and kind.kind == stored.kind == "S" and stored.itemsize == kind.itemsize
    typed = stored.kind in "fiubc" if kind is None else texts or stored == kind
    said = (
        f"holds {stored}, expected {kind or 'numbers'}"
        if not typed
        else f"has the shape {found.id.shape}, expected {shape}"
        if not shaped or found.id.shape is None
        else "is stored outside of the file"
        if kept == h5d.VIRTUAL or properties.get_external_count()
        else f"is stored by a filter of {filters}, which h5py does not bring itself"
        if not set(filters) <= _FILTERS
        else "has fewer rows than were committed"
        if rows is not None and (not lengths or lengths[0] < rows)
        else ""
    )
    if said:
        raise StructureError(f"{name} {said}")
    # HDF5 unpacks whole chunks; two filters copy each.
    if 4 * math.prod(chunk) * stored.itemsize > allowance.limit:
        raise LimitError(f"{name} is stored in chunks of {chunk}, more than the limit of {allowance.limit}")
    read = lengths if rows is None else (rows, *lengths[1:])
    allowance.take(f"{group.name}/{name}".lstrip("/"), stored.itemsize * math.prod(read))
    return found


def order(array: Any) -> str:
    """Memory order, "F" or "C", which decides BLAS's round-off."""
    return "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"


def write_problem(file: Any, description: str, arrays: Mapping[str, Any]) -> None:
    """Write the problem group."""
    group = file.create_group(PROBLEM)
    group.attrs.update({"description": description, "checksum": np.uint32(zlib.crc32(description.encode()))})
    write_arrays(group, arrays)


def write_arrays(group: Any, arrays: Mapping[str, Any]) -> None:
    """Write arrays with checksums."""
    for name, array in arrays.items():
        stored = group.create_dataset(name, data=array)
        stored.attrs.update({"order": order(array), "checksum": np.uint32(digest(array))})


def read_arrays(group: Any, allowance: Allowance) -> dict[str, Any]:
    """Arrays, checked."""
    arrays = {}
    for name in group:
        found = dataset(group, name, None, None, allowance)
        lying: Literal["C", "F"] = "F" if found.attrs.get("order") == "F" else "C"
        arrays[name] = np.asarray(found[()], order=lying)
        if digest(arrays[name]) != found.attrs["checksum"]:
            raise DamageError(f"the array {name} of its {group.name} is not what was written")
    return arrays


def read_problem(group: Any, allowance: Allowance) -> tuple[str, Mapping[str, Any]]:
    """Description and arrays, checked."""
    description = str(group.attrs["description"])
    if zlib.crc32(description.encode(errors="replace")) != group.attrs["checksum"]:
        raise DamageError("the description of its problem is not what was written")
    return description, read_arrays(group, allowance)
