"""Datasets of a file that may come from anybody: of the type expected, stored in the file itself, as large as they say.

External, soft and user-defined links, virtual and external storage, and filters that are not ours are refused: each of
them lets a file show what is not in it. What is taken out of one file is counted by one `Allowance`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5l, h5o, h5z

LEAST_BYTES = 1 << 27
"""Bytes of memory that any file may ask for. Copying takes three times as much, with numpy and scipy 500 MB in all;
with half as many a compressed path of 50,000 points is refused."""

UNFOLDING = 32
"""Times its own size that a larger file may ask for. Stored as it is, a point of two unknowns has 120 bytes or more,
and as a `Step` 1.5 KiB: 13 times as many, and twice that where it is compressed. Of zeros gzip makes a thousandth."""

COLUMN_BYTES = 1 << 14
"""Bytes of chunks that HDF5 keeps of each open dataset, so what one costs: tables are read from end to end."""

_FILTERS = (h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32, h5z.FILTER_LZF)
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
    """A group or dataset in a group, by a hard link.

    Raises `StructureError` if there is none of that name, or it is a link to somewhere else.
    """
    raw = name.encode()
    if raw not in group.id:
        raise StructureError(f"it has no {name}")
    if group.id.links.get_info(raw).type != h5l.TYPE_HARD:
        raise StructureError(f"{name} is a link to somewhere else")
    # As `group[name]`, which makes a new object of the whole file each time.
    found = h5o.open(group.id, raw)
    return h5py.Dataset(found) if isinstance(found, h5d.DatasetID) else h5py.Group(found)


def names(group: Any) -> list[str]:
    """The names of all that is in a group; `StructureError` if two are names of one thing, which would count twice."""
    known: dict[Any, str] = {}
    for raw in group.id:
        link, name = group.id.links.get_info(raw), raw.decode(errors="surrogateescape")
        if known.setdefault((link.type, link.u if link.type == h5l.TYPE_HARD else raw), name) != name:
            raise StructureError(f"{name} is stored once, under two names")
    return list(known.values())


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
    stored, lengths, properties = found.dtype, found.shape, found.id.get_create_plist()
    if kind is not None and stored != kind and not (kind.kind == "S" and stored.itemsize == kind.itemsize):
        raise StructureError(f"{name} holds {stored}, expected {kind}")
    if kind is None and stored.kind not in "fiubc":
        raise StructureError(f"{name} holds {stored}, expected numbers")
    if shape is not None and (
        lengths is None or len(lengths) != len(shape) or any(n is not None and n != m for n, m in zip(shape, lengths))
    ):
        raise StructureError(f"{name} has the shape {lengths}, expected {tuple(shape)}")
    layout = properties.get_layout()
    if layout == h5d.VIRTUAL or properties.get_external_count():
        raise StructureError(f"{name} is stored outside of the file")
    for k in range(properties.get_nfilters()):
        code = properties.get_filter(k)[0]
        if code not in _FILTERS:
            raise StructureError(f"{name} is stored by the filter number {code}, which h5py does not bring itself")
    if rows is not None and (not lengths or lengths[0] < rows):
        raise StructureError(f"{name} has fewer rows than were committed")
    # A chunk is unfolded whole, and each of two filters makes a copy of it.
    if layout == h5d.CHUNKED and 4 * math.prod(properties.get_chunk()) * stored.itemsize > allowance.limit:
        chunk = properties.get_chunk()
        raise LimitError(f"{name} is stored in chunks of {chunk}, more than the limit of {allowance.limit}")
    read = () if lengths is None else lengths if rows is None else (rows, *lengths[1:])
    allowance.take(f"{group.name}/{name}".lstrip("/"), stored.itemsize * math.prod(read))
    return found
