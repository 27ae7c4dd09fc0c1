"""`recover`: what a killed writer left, made into a whole file."""

from __future__ import annotations

import os
import socket
from os import PathLike
from pathlib import Path as File
from typing import Any

from continuation.archive.checkpoint import Checkpoint, pack
from continuation.archive.copies import Share, put, write_copy
from continuation.archive.errors import ArchiveError
from continuation.archive.files import check_writable
from continuation.archive.provenance import history
from continuation.archive.reader import Archive, open_archive
from continuation.archive.schema import TEXT, text
from continuation.status import Status


def recover(file: str | PathLike[str], *, force: bool = False) -> File:
    """Make the file of a killed writer whole: its committed rows, copied, in its place.

    A path without an end gets the status INTERRUPTED, and can be resumed. A file that was closed properly stays as
    it is.

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
        If it is no archive, is damaged beyond its committed rows, is read-only, or is being written.
    """
    name = File(file)
    with open_archive(name) as archive:
        if archive.closed_by_writer and (not len(archive) or archive.paths["status"][-1] != Status.TRACING):
            return name
        if not archive.closed_by_writer and not force:
            check_dead(archive)
        attributes = {**archive.attributes, **history(archive.attributes, "recovered after its writer was killed")}
        share = Share(archive, len(archive), archive.points.size, _ended)
        slots = kept(archive.checkpoint())
        check_writable(name)
        put(name, lambda part: write_copy([share], part, attributes=attributes, checkpoints=slots)).close()
    return name


def _ended(block: dict[str, Any]) -> dict[str, Any]:
    """A path that was being traced when its writer died counts as interrupted."""
    open_ = block["status"] == int(Status.TRACING)
    block["status"][open_] = int(Status.INTERRUPTED)
    block["message"][open_] = text(f"{Status.INTERRUPTED} Its writer was killed.", TEXT)
    return block


def kept(checkpoint: Checkpoint | None) -> dict[int, bytes]:
    """The checkpoint in the first slot of a new file."""
    return {} if checkpoint is None else {0: pack(checkpoint)}


def check_dead(archive: Archive) -> None:
    """Refuse a file whose writer may still be at work.

    Raises
    ------
    ArchiveError
        If the process that it names is alive on this host.
    """
    process, host = int(archive.attributes.get("process", 0)), archive.attributes.get("host")
    if host != socket.gethostname() or process <= 0:
        return
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return
    except PermissionError:
        pass
    raise ArchiveError(
        f"{archive.file}: process {process}, which writes it, seems to be alive; end it first, or say force=True"
    )
