"""`recover`: what a killed writer or a damaged disk left, made into a whole file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import closing
from os import PathLike
from pathlib import Path as File
from typing import Any

from continuation.archive.atomic import as_file
from continuation.archive.checkpoint import Checkpoint, pack
from continuation.archive.contents import Contents
from continuation.archive.copies import everything, interrupt, put, write_copy
from continuation.archive.errors import ArchiveError
from continuation.archive.files import check_writable
from continuation.archive.locks import Lock, locked
from continuation.archive.provenance import history
from continuation.archive.reader import open_archive
from continuation.archive.salvage import nothing, salvaged
from continuation.archive.structure import SLOTS
from continuation.status import Status


def recover(file: str | PathLike[str], *, force: bool = False) -> File:
    """Make the file of a killed writer whole: its committed rows, copied, in its place.

    A path without an end gets the status INTERRUPTED, and can be resumed. A file that was closed properly and is sound
    stays as it is. Of a damaged one the sound rows are kept: a path is cut before its first row that is not what was
    written, and the damaged file is kept beside as ``NAME.damaged``.

    Parameters
    ----------
    file : path
    force : bool
        Also if the process that wrote it seems to be alive. A file that is still being written must not be
        recovered: its writer would go on with the old one.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    ArchiveError
        If it is no archive, its structure is damaged, it is read-only, or is being written.
    """
    name = as_file("file", file)
    with closing(Contents(name, salvage=True)) as contents:
        lost = {table: contents.unsound(table) for table in ("point", "path")}
        damaged = any(lost.values()) or any(contents.cut_off.values())
        if not damaged and not contents.flaws:
            return _ended(name, force)
        real = File(os.path.realpath(name))
        with closing(own(contents, real, force=force)):
            shares = salvaged(contents, lost)
            if not shares and not damaged:
                shares = [nothing(contents)]
            if not shares:
                raise ArchiveError(f"{name}: is damaged, and none of its rows is sound")
            dropped = sum(stop - start for start, stop in lost["point"]) + contents.cut_off["point"]
            what = f"recovered: {'; '.join(contents.flaws) or 'damaged'}; {dropped} points were not what was written"
            attributes = _legible({**contents.attributes, **history(contents.attributes, what)})
            # What is dropped may be worth more to somebody else than it is to us.
            if damaged:
                _keep_aside(real)
            put(real, lambda part: write_copy(shares, part, attributes=attributes), replace=True)
    return name


def _ended(name: File, force: bool) -> File:
    """A sound file, closed, with its last path ended."""
    with open_archive(name) as archive:
        if archive.closed_by_writer and (not len(archive) or archive.paths["status"][-1] != Status.TRACING):
            return name
        real = File(os.path.realpath(name))
        with closing(own(archive.contents, real, force=force)):
            attributes = {**archive.attributes, **history(archive.attributes, "recovered after its writer was killed")}
            share = everything(archive)
            interrupt(share.paths)
            slots = kept(archive.checkpoint())
            put(real, lambda part: write_copy([share], part, attributes=attributes, checkpoints=slots), replace=True)
    return name


def _keep_aside(file: File) -> None:
    """The damaged file under a name of its own."""
    aside = file.with_name(f"{file.name}.damaged")
    try:
        os.link(file, aside)
    except FileExistsError:
        raise ArchiveError(f"{file}: is damaged, and would be kept as {aside.name}, which exists already") from None
    except OSError as error:
        raise ArchiveError(f"{file}: is damaged, and cannot be kept as {aside.name} ({error.strerror})") from None


def _legible(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes that can be written again, whatever happened to their text."""
    return {
        name.encode(errors="replace").decode(): value.encode(errors="replace").decode()
        if isinstance(value, str) else value
        for name, value in attributes.items()
    }  # fmt: skip


def kept(checkpoint: Checkpoint | None) -> dict[int, bytes]:
    """The checkpoint in its slot of a new file, which is not the one that the next is written to."""
    return {} if checkpoint is None else {checkpoint.sequence % SLOTS: pack(checkpoint)}


def own(contents: Contents, file: File, *, force: bool = False) -> Lock:
    """The right to replace a file (no link to it) that was read; by force also if its writer seems to be at work.

    Raises `ArchiveError` if it may not be written, is being written, or was replaced since it was opened.
    """
    check_writable(file)
    return locked(file, contents.descriptor, f"process {contents.attributes.get('process', 'unknown')}", force=force)
