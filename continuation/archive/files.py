"""Opening a file for reading, with one clear line for each thing that can be wrong with it."""

from __future__ import annotations

import os
import struct
import time
from os import PathLike
from pathlib import Path as File
from typing import Any

import h5py

from continuation.archive.errors import ArchiveError
from continuation.archive.schema import SCHEMA

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# The superblock, version 3: byte 8 is the version, byte 11 says whether and how a writer has the file open, and at
# byte 28 there is the length that the file is to have.
_VERSION, _IN_USE, _LENGTH, _HEAD = 8, 11, 28, 36
_SWMR = 4
_PATIENCE = 0.2


def open_for_reading(file: str | PathLike[str]) -> tuple[Any, bool]:
    """The open HDF5 file, and whether its writer closed it.

    Raises
    ------
    ArchiveError
        For a file that is missing, unreadable, not HDF5, truncated, foreign, or of a newer schema.
    """
    name = File(file)
    head = _head(name)
    closed = head[_VERSION] < 3 or not head[_IN_USE]
    if not closed:
        _check_length(name)
    try:
        # A file under SWMR, growing or left by a kill, can be read as such only.
        opened = h5py.File(name, "r") if closed else h5py.File(name, "r", libver="latest", swmr=True)
    except OSError as error:
        raise ArchiveError(f"{name}: truncated or damaged, HDF5 cannot open it ({_reason(error)})") from None
    try:
        _check_schema(name, opened)
    except BaseException:
        opened.close()
        raise
    return opened, closed


def _head(name: File) -> bytes:
    """The first bytes, if they are those of an HDF5 file."""
    if name.is_dir():
        raise ArchiveError(f"{name}: is a directory, an archive is a file")
    try:
        with name.open("rb") as raw:
            head = raw.read(_HEAD)
    except FileNotFoundError:
        raise ArchiveError(f"{name}: there is no such file") from None
    except PermissionError:
        raise ArchiveError(f"{name}: may not be read (permissions)") from None
    if not head:
        raise ArchiveError(f"{name}: is empty; its writer ended before anything was written")
    if not head.startswith(_SIGNATURE):
        raise ArchiveError(f"{name}: is not an HDF5 file, so not an archive")
    if len(head) < _HEAD:
        raise ArchiveError(f"{name}: truncated, only its first {len(head)} bytes are there")
    return head


def _check_length(name: File) -> None:
    """Whether a file under SWMR is as long as it says: HDF5 would wait for the missing part without end.

    A writer at work may be about to lengthen it, so it gets a moment.
    """
    end = time.monotonic() + _PATIENCE
    while True:
        head = _head(name)
        (length,) = struct.unpack_from("<Q", head, _LENGTH)
        missing = length - name.stat().st_size
        if missing <= 0 and head[_IN_USE] & _SWMR:
            return
        if time.monotonic() > end and not head[_IN_USE] & _SWMR:
            raise ArchiveError(f"{name}: truncated, its writer ended before the structure was complete")
        if time.monotonic() > end:
            raise ArchiveError(f"{name}: truncated or damaged, its last {missing} bytes are missing")
        time.sleep(0.02)


def _check_schema(name: File, opened: Any) -> None:
    try:
        schema = opened.attrs.get("schema")
        complete = "committed_points" in opened and "committed_paths" in opened
    except (OSError, RuntimeError, KeyError) as error:
        raise ArchiveError(f"{name}: truncated or damaged, its root cannot be read ({_reason(error)})") from None
    if schema is None and not complete:
        raise ArchiveError(f"{name}: is an HDF5 file, but not an archive of paths (it has no attribute `schema`)")
    kind, _, version = str(schema).rpartition("-")
    ours, _, newest = SCHEMA.rpartition("-")
    if kind != ours or not version.isdigit():
        raise ArchiveError(f"{name}: has the schema {str(schema)[:60]!r}, expected {SCHEMA!r}")
    if int(version) > int(newest):
        writer = opened.attrs.get("library_version", "unknown")
        raise ArchiveError(
            f"{name}: has the newer schema {schema}, this library reads up to {SCHEMA}; "
            f"upgrade to continuation {writer} or later, or read it with h5py or xarray"
        )
    if not complete:
        raise ArchiveError(f"{name}: truncated, its writer ended before the structure was complete")


def check_writable(file: File) -> None:
    """Whether a file may be replaced.

    Raises
    ------
    ArchiveError
        If it is read-only, or its directory is.
    """
    # The mode too, since root may write everything: who took the right away meant it.
    if not os.access(file, os.W_OK) or not file.stat().st_mode & 0o222:
        raise ArchiveError(f"{file}: is read-only; copy it, or write to another file")
    if not os.access(file.parent, os.W_OK):
        raise ArchiveError(f"{file}: the directory {file.parent} may not be written; copy the file to another one")


def _reason(error: BaseException) -> str:
    return str(error).splitlines()[0][:160]
