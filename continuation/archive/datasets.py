"""Datasets of a file that may come from anybody: of the type expected, stored in the file itself, as large as they say.

External, soft and user-defined links, virtual and external storage, and filters that are not ours are refused: each of
them lets a file show what is not in it. Sizes claimed are held against the bytes that are there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5l, h5o, h5z

DATASET_BYTES = 1 << 28
"""Bytes that a compressed dataset may unfold to, unless the caller says more. Others are no larger than their file."""

_CHUNK = 1 << 26
"""Bytes of a chunk, or a quarter of the limit: HDF5 unfolds it whole. Ours have 512 KiB, or one row."""

_FILTERS = (h5z.FILTER_DEFLATE, h5z.FILTER_SHUFFLE, h5z.FILTER_FLETCHER32, h5z.FILTER_LZF)
"""Those that h5py brings itself; any other would be a library that is loaded to read the file."""


class StructureError(ValueError):
    """Something that is in no archive; the message says what."""


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
    """The names of all that is in a group."""
    return [raw.decode(errors="surrogateescape") for raw in group.id]


def subgroup(group: Any, name: str) -> Any:
    """A group in a group; `StructureError` if it is anything else."""
    found = member(group, name)
    if not isinstance(found, h5py.Group):
        raise StructureError(f"{name} is no group")
    return found


def dataset(
    group: Any, name: str, kind: np.dtype[Any] | None, shape: Sequence[int | None] | None, limit: int = DATASET_BYTES
) -> Any:
    """A dataset in a group, its storage checked.

    Without a `kind` it holds any numbers; a length of None is checked when rows are read; `limit` counts the bytes that
    it may unfold to where it is compressed. Raises `StructureError` if it is something else, or could be larger than
    what is stored of it.
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
    if layout == h5d.CHUNKED and math.prod(properties.get_chunk()) * stored.itemsize > max(_CHUNK, limit >> 2):
        raise StructureError(f"{name} is stored in chunks of {properties.get_chunk()}")
    if lengths is not None and (shape is None or None not in shape):
        check_size(found, math.prod(lengths) * stored.itemsize, limit)
    return found


def check_size(found: Any, claimed: int, limit: int = DATASET_BYTES) -> None:
    """Whether so many bytes may be read of a dataset.

    Raises `StructureError` if less is stored, or more than the limit would unfold from what is.
    """
    stored = found.id.get_storage_size()
    if claimed <= stored:
        return
    compressed = found.id.get_create_plist().get_nfilters() > 0
    if claimed > (limit if compressed else stored):
        where = f"more than the limit of {limit}; say limit=" if compressed else f"but only {stored} are stored"
        raise StructureError(f"{found.name[1:]} claims {claimed} bytes, {where}")
