"""Checksums: of each block of rows, column by column, and of the records that say how much was committed.

A block is what one commit wrote. Its checksums stand in ``/checks``, one row a block: where the block ends, then one
number a column in the order of their names. What a reader takes from the file, it compares.

A commit has two records. The *intent* is written with the rows, the *commit* after all that is on its way to the disk;
each has two places that are used in turn. A process killed anywhere tears one record at most, and then the other three
tell what it said: so a damaged record is never taken for an unfinished one.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import astuple, frozen

GROUP = "checks"
RECORDS = "commits"
PLACES = 2
RECORD_BYTES = 7 * 8 + 4
_BOUNDS = struct.Struct("<QQ")
STOP = 2
"""Words of a row that hold the end of its block."""

_LARGE = 1 << 16
"""Bytes from which a matrix is checked by the sums of its rows and columns: a CRC-32 makes 2.7 GB/s here, sums 40."""

Array = np.ndarray[Any, Any]


class DamageError(ValueError):
    """What was read is not what was written; the message says which rows of which column, and which are sound."""


@frozen
class Committed:
    """How much of a file is valid: a commit's number; rows, blocks, event names and the last checkpoint up to it."""

    sequence: int = 0
    points: int = 0
    paths: int = 0
    point_blocks: int = 0
    path_blocks: int = 0
    names: int = 0
    checkpoint: int = 0

    def pack(self) -> Array:
        """As bytes, with a CRC-32."""
        body = np.array(astuple(self), "<u8").tobytes()
        return np.frombuffer(body + struct.pack("<I", zlib.crc32(body)), "u1")


def blank() -> Array:
    """The records of a new file, shape (4, bytes): intents, then commits, each valid and older than the first."""
    return np.array([Committed(sequence=k % PLACES).pack() for k in range(2 * PLACES)])


def latest(records: Array) -> Committed:
    """The last commit that was completed; `DamageError` if the records do not tell."""
    sound = [zlib.crc32(raw[:-4]) == int.from_bytes(raw[-4:].tobytes(), "little") for raw in records]
    found = [Committed(*np.frombuffer(raw[:-4], "<u8").tolist()) if ok else None for raw, ok in zip(records, sound)]
    commits = [one for one in found[PLACES:] if one is not None]
    last = max(commits, key=lambda one: one.sequence, default=None)
    if last is not None and len(commits) < PLACES:
        # The other is torn or damaged: the intent tells whether a later commit had come so far as to write there.
        intent = found[(last.sequence + 1) % PLACES]
        last = None if intent is None else max(last, intent, key=lambda one: one.sequence)
    if last is None:
        raise DamageError("the records of what was committed are damaged")
    return last


def digest(values: Any, seed: int = 0) -> int:
    """32 bits that differ for any damage that is likely: CRC-32, of large matrices that of their sums."""
    whole: Any = np.ascontiguousarray(values)
    if whole.ndim == 2 and whole.nbytes >= _LARGE and whole.itemsize == 8:
        words = whole.view("u8")
        return zlib.crc32(np.add.reduce(words, axis=1), zlib.crc32(np.add.reduce(words, axis=0), seed))
    return zlib.crc32(whole, seed)


def seal(block: Mapping[str, Array], start: int) -> Array:
    """The row of checksums of a block that begins at row `start`."""
    stop = start + len(next(iter(block.values())))
    seed = zlib.crc32(_BOUNDS.pack(start, stop))
    sums = [digest(block[name], seed) for name in sorted(block)]
    return np.array([stop & 0xFFFFFFFF, stop >> 32, *sums], dtype="u4")


class Ledger:
    """The checksums of one table of `size` rows, as read from a file: what `seal` returned, one row a block.

    Without a size the blocks are those up to the first that cannot be one, as in a file that is cut off. Raises
    `DamageError` if the blocks are not those of so many rows.
    """

    def __init__(self, rows: Array, columns: Sequence[str], size: int | None) -> None:
        stops = rows[:, 0].astype("i8") | (rows[:, 1].astype("i8") << 32)
        bounds = np.concatenate(([0], stops))
        wrong = np.flatnonzero(np.diff(bounds) <= 0)
        if size is None:
            bounds = bounds[: wrong[0] + 1] if wrong.size else bounds
        elif bounds[-1] != size or wrong.size:
            raise DamageError("the checksums are damaged")
        self.bounds, self.rows = bounds, int(bounds[-1])
        self._sums, self._place = rows[:, STOP:], {name: k for k, name in enumerate(sorted(columns))}

    def read(self, name: str, rows: slice, fetch: Callable[[slice], Array]) -> Array:
        """Rows of a column, checked; `fetch` reads them, in whole blocks.

        Raises `DamageError` if some of their blocks are not what was written.
        """
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
