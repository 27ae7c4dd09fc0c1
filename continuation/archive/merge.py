"""`merge`: many archives as one; so are the files of the workers of a sweep."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from os import PathLike
from pathlib import Path as File

import numpy as np
from attrs import evolve

from continuation.archive.atomic import ArchiveError, as_file, check_new
from continuation.archive.copies import (
    Share,
    check_level,
    leading,
    share_of,
    write_copy,
)
from continuation.archive.provenance import history, process
from continuation.archive.reader import Archive, open_archive
from continuation.archive.schema import TEXT, text
from continuation.archive.store import put
from continuation.arguments.checks import complain
from continuation.status import Status


def merge(
    files: Iterable[str | PathLike[str]], target: str | PathLike[str], *, compression: int = 0, title: str = ""
) -> File:
    """Concatenate archives, in the order given: paths are numbered anew, everything else stays as it is.

    Files of killed writers count with what was committed. Each path keeps its homotopy and its source, the columns
    ``homotopy`` and ``source`` of the path table; the settings and the problem of the first file are those of the new
    one, which cannot be resumed.

    Parameters
    ----------
    files : iterable of path
    target : path
        Must not exist.
    compression : int
        Level of gzip, 0 to 9.
    title : str

    Raises
    ------
    ValueError
        If there are no files, or gzip does not know the level.
    ArchiveError
        If one is no archive, has another number of unknowns than the first, or a path that another has too, or if
        `target` exists.
    """
    if isinstance(files, (str, bytes, PathLike)) or not isinstance(files, Iterable):
        raise complain(TypeError, "files", "names of archives, in a list", files)
    files = list(files)
    if not files:
        raise ValueError("files: expected at least one archive, found none")
    check_level(compression)
    whole = as_file("target", target)
    check_new(whole)
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        shares = [share_of(archive) for archive in archives]
        first = leading(shares).attributes
        names = ", ".join(archive.file.name for archive in archives[:8]) + (", ..." if len(archives) > 8 else "")
        attributes = {**first, **process(), **history(first, f"merged from {len(archives)} files: {names}")}
        if title:
            attributes["title"] = title
        _refuse_duplicates(archives, shares)
        put(whole, lambda part: write_copy(shares, part, attributes=attributes, compression=compression))
    return whole


def _refuse_duplicates(archives: Sequence[Archive], shares: Sequence[Share]) -> None:
    """A path that is in two of the files would count twice in every average."""
    known: dict[bytes, str] = {}
    for archive, share in zip(archives, shares):
        for k, source in enumerate(share.paths["source"]):
            # The identifier and the number; the name of the file may have been changed since.
            key = b" ".join(source.split(b" ", 2)[:2])
            if key in known:
                raise ArchiveError(f"{archive.file}: its path {k} is {known[key]} as well; expected each path once")
            known[key] = f"path {k} of {archive.file}"


def gather(files: Sequence[File], target: File) -> None:
    """Merge the parts of a sweep, in the order of its members; those of other sizes than the first keep no points."""
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        places = []
        for archive in archives:
            archive.paths.load()
            places += [(member, archive, k) for k, member in enumerate(archive.paths["member"].tolist())]
        shares = [share_of(archive, k, k + 1) for _, archive, k in sorted(places, key=lambda place: place[0])]
        head = leading(shares)
        shares = [_of_size(share, head.layout.unknowns, target) for share in shares]
        attributes = {**head.attributes, **process(), **history(head.attributes, f"a sweep of {len(shares)} paths")}
        put(target, lambda part: write_copy(shares, part, attributes=attributes))


def _of_size(share: Share, unknowns: int, target: File) -> Share:
    """The share; if its paths have another number of unknowns, what they would be in one file: refused."""
    found = share.layout.unknowns
    if found == unknowns or not share.size:
        return share
    reason = f"ValueError: homotopy: expected {unknowns} unknowns, as in {target} so far, found {found}"
    paths = dict(share.paths)
    for name, value in {"status": int(Status.RAISED), "message": text(reason, TEXT), "n_points": 0}.items():
        paths[name] = np.full_like(paths[name], value)
    return evolve(share, paths=paths, points=slice(0, 0))
