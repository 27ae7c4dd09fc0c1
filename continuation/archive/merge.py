"""`merge`: many archives as one."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from os import PathLike
from pathlib import Path as File

from continuation.archive.atomic import check_new
from continuation.archive.copies import everything, leading, put, write_copy
from continuation.archive.provenance import history, process
from continuation.archive.reader import open_archive


def merge(
    files: Sequence[str | PathLike[str]], target: str | PathLike[str], *, compression: int = 0, title: str = ""
) -> File:
    """Concatenate archives, in the order given: paths are numbered anew, everything else stays as it is.

    Files of killed writers count with what was committed. The settings and the problem of the first file are those of
    the new one; it cannot be resumed.

    Parameters
    ----------
    files : sequence of path
    target : path
        Must not exist.
    compression : int
        Level of gzip, 0 to 9.
    title : str

    Raises
    ------
    ValueError
        If there are no files.
    ArchiveError
        If one is no archive, has another number of unknowns than the first, or `target` exists.
    """
    if not files:
        raise ValueError("files: expected at least one archive, found none")
    whole = File(target)
    check_new(whole)
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        first = leading([archive.contents for archive in archives]).attributes
        names = ", ".join(archive.file.name for archive in archives[:8]) + (", ..." if len(archives) > 8 else "")
        attributes = {**first, **process(), **history(first, f"merged from {len(archives)} files: {names}")}
        if title:
            attributes["title"] = title
        shares = [everything(archive) for archive in archives]
        put(whole, lambda part: write_copy(shares, part, attributes=attributes, compression=compression))
    return whole
