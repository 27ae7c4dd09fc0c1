"""Checksums of blocks of rows, and the records of commits.

A block is one commit's rows. Its row in ``/checks`` holds its end and a checksum for each column, by name.

A commit writes two records, *intent* and *commit*, each alternating between two places. A kill tears at most one; the
other three determine it.
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
"""Places that are written in turn, of records and of checkpoints."""

RECORD = struct.Struct("<7QI")
"""A `Committed` with its CRC-32."""

_BOUNDS = struct.Struct("<QQ")

_LARGE = 1 << 16
"""Bytes from which a matrix is checked by sums of rows and columns: CRC-32 runs at 2.7 GB/s, sums at 40 GB/s."""

Array = np.ndarray[Any, Any]


class DamageError(ValueError):
    """Data that differ from those written."""


@frozen
class Committed:
    """The valid part of a file."""

    sequence: int = 0
    points: int = 0
    paths: int = 0
    point_blocks: int = 0
    path_blocks: int = 0
    names: int = 0
    checkpoint: int = 0

    def rows(self, table: str) -> int:
        """Valid rows of ``"point"`` or ``"path"``."""
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
    """CRC-32, for large matrices of row and column sums."""
    whole: Any = np.ascontiguousarray(values)
    if whole.ndim == 2 and whole.nbytes >= _LARGE and whole.itemsize == 8:
        words = whole.view("u8")
        return zlib.crc32(np.add.reduce(words, axis=1), zlib.crc32(np.add.reduce(words, axis=0), seed))
    return zlib.crc32(whole, seed)


def seal(block: Mapping[str, Array], start: int) -> Array:
    """The checksum row of a block from row `start`."""
    stop = start + len(next(iter(block.values())))
    seed = zlib.crc32(_BOUNDS.pack(start, stop))
    sums = [digest(block[name], seed) for name in sorted(block)]
    return np.array([stop & 0xFFFFFFFF, stop >> 32, *sums], dtype="u4")


class Ledger:
    """Checksums of a table of `rows` rows, by block, as far as the blocks make sense."""

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
