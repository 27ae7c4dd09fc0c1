"""`merge`: many archives as one; so are the files of the workers of a sweep."""

from __future__ import annotations

import glob
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from os import PathLike
from pathlib import Path as File

import numpy as np
from attrs import evolve

from continuation.archive.atomic import as_file, check_new
from continuation.archive.copies import (
    Share,
    check_level,
    interrupt,
    leading,
    share_of,
    write_copy,
)
from continuation.archive.errors import ArchiveError
from continuation.archive.locks import is_held
from continuation.archive.provenance import history, process
from continuation.archive.reader import Archive, open_archive
from continuation.archive.schema import TEXT, text
from continuation.archive.store import put
from continuation.archive.workers import Batch
from continuation.archive.writer import PathLog
from continuation.arguments.checks import complain
from continuation.status import Status

THREAD_SECONDS = 10.0
"""Seconds for those that cannot be ended, as threads: a file is merged when its writer has left it."""

_LOOK = 0.05
"""Seconds between two looks whether a file has been left."""


def finished(batch: Batch) -> set[int]:
    """The numbers of the homotopies whose paths a lost worker had finished."""
    found: set[int] = set()
    if batch.file is not None:
        for file in batch.file.parent.glob(f"{glob.escape(batch.file.stem)}*{batch.file.suffix}"):
            with suppress(ArchiveError), open_archive(file) as part:
                ended = part.paths["status"] != int(Status.TRACING)
                found.update(part.paths["member"][ended].tolist())
    return found


def end_repeats(target: File, token: str, sign: File) -> None:
    """Let those end that do a batch again whose result is here: dask begins it elsewhere when its worker dies then."""
    until = time.monotonic() + THREAD_SECONDS
    while any(map(is_held, _files(target, token))) and time.monotonic() < until:
        sign.touch()
        time.sleep(_LOOK)


def _files(target: File, token: str) -> list[File]:
    """Those of the workers of a sweep."""
    return sorted(target.parent.glob(f"{glob.escape(target.stem)}.sweep-{token}.*{glob.escape(target.suffix)}"))


def collect(
    batches: Sequence[Batch], errors: Mapping[int, BaseException], target: File, token: str, stopped: bool
) -> None:
    """Merge the workers' files; what was lost is there as failures, unless Ctrl-C is why it is not there."""
    lost = target.with_name(f"{target.stem}.sweep-{token}.lost{target.suffix}")
    if errors and not stopped:
        tasks = {batch.first + i: homotopy for batch in batches for i, homotopy in enumerate(batch.homotopies)}
        with PathLog(lost) as log:
            for number, error in sorted(errors.items()):
                log.member = number
                log.failure(tasks[number], error)
    files = _files(target, token)
    if files:
        gather(files, target, finished=stopped)
    # What a worker was writing when it was ended is named after its file, and nobody writes it any more.
    parts = target.parent.glob(f".{glob.escape(target.stem)}.sweep-{token}.*{glob.escape(target.suffix)}.*.part")
    for file in (*files, *(part for part in parts if not is_held(part))):
        file.unlink()


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


def gather(files: Sequence[File], target: File, *, finished: bool = False) -> None:
    """Merge the parts of a sweep, in the order of its members: of each the path that was finished, or what there is.

    The files are those of all workers, also of killed ones; later attempts at a member may be in other files. Paths
    without an end are left out if `finished`. Where there is nothing, no target is made.
    """
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        chosen: dict[int, tuple[bool, int, int]] = {}
        for k, archive in enumerate(archives):
            ends = zip(archive.paths["member"].tolist(), archive.paths["status"].tolist(), strict=True)
            for index, (member, status) in enumerate(ends):
                if finished and status == int(Status.TRACING):
                    continue
                candidate = (status in (int(Status.TRACING), int(Status.INTERRUPTED)), k, index)
                chosen[member] = min(chosen.get(member, candidate), candidate)
        shares = []
        for first, last in _runs([chosen[member][1:] for member in sorted(chosen)]):
            shares.append(share_of(archives[first[0]], first[1], last[1] + 1))
            interrupt(shares[-1].paths)
        if not shares:
            return
        lead = leading(shares)
        shares = [_of_size(share, lead.layout.unknowns, target) for share in shares]
        head = lead.attributes
        attributes = {**head, **process(), **history(head, f"merged from the {len(archives)} files of a sweep")}
        put(target, lambda part: write_copy(shares, part, attributes=attributes))


def _of_size(share: Share, unknowns: int, target: File) -> Share:
    """The share; if its paths have another number of unknowns, what they would be in one file: refused."""
    found = share.source.layout.unknowns
    if found == unknowns or not share.size:
        return share
    reason = f"ValueError: homotopy: expected {unknowns} unknowns, as in {target} so far, found {found}"
    begun, paths = share.paths["n_points"] > 0, dict(share.paths)
    for name, value in {"status": int(Status.RAISED), "message": text(reason, TEXT), "n_points": 0}.items():
        paths[name] = np.where(begun, np.array(value, dtype=paths[name].dtype), paths[name])
    return evolve(share, paths=paths, points=slice(0, 0))


def _runs(places: Sequence[tuple[int, int]]) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
    """First and last of the runs of (file, path) that stand one after another in one file."""
    first = 0
    for k in range(1, len(places) + 1):
        if k == len(places) or places[k] != (places[k - 1][0], places[k - 1][1] + 1):
            yield places[first], places[k - 1]
            first = k
