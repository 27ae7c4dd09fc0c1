"""Opening a file for reading, with one clear line for each thing that can be wrong with it."""

from __future__ import annotations

import os
from pathlib import Path as File
from typing import Any

import h5py

from continuation.archive.atomic import short
from continuation.archive.checks import GROUP, RECORDS
from continuation.archive.datasets import COLUMN_BYTES
from continuation.archive.errors import ArchiveError
from continuation.archive.image import Image
from continuation.archive.schema import SCHEMA, UNCHECKED

FAULTS = (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, MemoryError, RecursionError)
"""What h5py raises for a file that is not what it should be."""


def hdf5(image: Image, *, truncated: bool = False) -> Any:
    """The HDF5 file in an image, open; where its end is missing, with zeros there if `truncated`.

    Raises `ArchiveError` for one that is not HDF5, truncated, foreign, or of a newer schema.
    """
    name = image.file
    _check_length(image, truncated)
    try:
        opened = h5py.File(image, "r", rdcc_nbytes=COLUMN_BYTES)
    except FAULTS as error:
        raise ArchiveError(f"{name}: truncated or damaged, HDF5 cannot open it ({short(error)})") from None
    try:
        _check_schema(name, opened)
    except BaseException:
        opened.close()
        raise
    return opened


def _check_length(image: Image, truncated: bool) -> None:
    if image.missing and not truncated:
        what = f"{image.file}: truncated or damaged, its last {image.missing} bytes are missing"
        raise ArchiveError(f"{what}; `recover` keeps the rows that are sound")
    if not image.closed_by_writer and not image.under_swmr:
        raise ArchiveError(f"{image.file}: truncated, its writer ended before the structure was complete")


def _check_schema(name: File, opened: Any) -> None:
    try:
        schema = opened.attrs.get("schema")
        complete = all(part in opened for part in ("committed_points", "committed_paths"))
        checked = GROUP in opened and RECORDS in opened[GROUP]
    except FAULTS as error:
        raise ArchiveError(f"{name}: truncated or damaged, its root cannot be read ({short(error)})") from None
    if schema is None and not complete:
        raise ArchiveError(f"{name}: is an HDF5 file, but not an archive of paths (it has no attribute `schema`)")
    kind, _, version = str(schema).rpartition("-")
    ours, _, newest = SCHEMA.rpartition("-")
    if kind != ours or not (version.isdecimal() and len(version) < 9):
        raise ArchiveError(f"{name}: has the schema {str(schema)[:60]!r}, expected {SCHEMA!r}")
    if int(version) > int(newest):
        try:
            writer = str(opened.attrs.get("library_version", "unknown"))[:20]
        except FAULTS:
            writer = "unknown"
        raise ArchiveError(
            f"{name}: has the newer schema {schema}, this library reads up to {SCHEMA}; "
            f"upgrade to continuation {writer} or later, or read it with h5py or xarray"
        )
    if not complete or not (checked or schema == UNCHECKED):
        raise ArchiveError(f"{name}: truncated, its writer ended before the structure was complete")


def check_writable(file: File) -> None:
    """Whether a file may be replaced; `ArchiveError` if it is read-only, or its directory is."""
    # The mode too, since root may write everything: who took the right away meant it.
    if not os.access(file, os.W_OK) or not file.stat().st_mode & 0o222:
        raise ArchiveError(f"{file}: is read-only; copy it, or write to another file")
    if not os.access(file.parent, os.W_OK):
        raise ArchiveError(f"{file}: the directory {file.parent} may not be written; copy the file to another one")
