"""What is done with whole archives: `merge`, `export`, `recover`, and putting the parts of a sweep in order.

All of them read whole blocks of rows and append them elsewhere (`continuation.archive.copies`).
"""

from __future__ import annotations

import csv
import gzip
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from functools import partial
from itertools import groupby, pairwise
from numbers import Integral
from os import PathLike
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import evolve

from continuation.archive.atomic import ArchiveError, as_file, beside, check_new, new_file, own, publish
from continuation.archive.checkpoint import slot_of
from continuation.archive.contents import TABLES, Contents
from continuation.archive.copies import Share, filled, leading, share_of, sourced, write_copy
from continuation.archive.reader import Archive, open_archive
from continuation.archive.rows import record_of, row_columns
from continuation.archive.schema import TEXT, text
from continuation.archive.store import put
from continuation.archive.tables import ROWS_AT_ONCE, Table, flat
from continuation.arguments.checks import complain
from continuation.path import Path
from continuation.status import Kind, Status


def merge(files: Iterable[str | PathLike[str]], target: str | PathLike[str]) -> File:
    """Concatenate archives, in the order given: paths are numbered anew, everything else stays as it is.

    Files of killed writers count with what was committed. Each path keeps its homotopy and its source, the columns
    ``homotopy`` and ``source`` of the path table; the settings and the problem of the first file are those of the new
    one, which cannot be resumed.

    Parameters
    ----------
    files : iterable of path
    target : path
        Must not exist.

    Raises
    ------
    ValueError
        If there are no files.
    ArchiveError
        If one is no archive, has another number of unknowns than the first, or a path that another has too, or if
        `target` exists.
    """
    if isinstance(files, (str, bytes, PathLike)) or not isinstance(files, Iterable):
        raise complain(TypeError, "files", "names of archives, in a list", files)
    files = list(files)
    if not files:
        raise ValueError("files: expected at least one archive, found none")
    whole = new_file("target", target)
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        shares = [share_of(archive) for archive in archives]
        names = ", ".join(archive.file.name for archive in archives[:8]) + (", ..." if len(archives) > 8 else "")
        _refuse_duplicates(archives, shares)
        put(whole, partial(write_copy, shares, what=f"merged from {len(archives)} files: {names}"))
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
        places = sorted((m, i, k) for i, one in enumerate(archives) for k, m in enumerate(one.paths["member"].tolist()))
        # Neighbours that are neighbours in their part, too, are read and written together.
        runs = [[*run] for _, run in groupby(enumerate(places), lambda at: (at[1][1], at[1][2] - at[0]))]
        shares = [share_of(archives[run[0][1][1]], run[0][1][2], run[-1][1][2] + 1) for run in runs]
        head, made = leading(shares), []
        for run, share in zip(runs, shares):
            # The source is not the part, which goes.
            share.paths["source"][:] = b""
            whole = sourced(share, str(head.attributes["identifier"]), target.name, first=run[0][0])
            made.append(_of_size(whole, head.layout.unknowns, target))
        put(target, partial(write_copy, made, what=f"a sweep of {len(places)} paths"))


def _of_size(share: Share, unknowns: int, target: File) -> Share:
    """The share; paths with another number of unknowns are what they would be in one file: refused."""
    found = share.layout.unknowns
    if found == unknowns or not share.size:
        return share
    reason = f"ValueError: homotopy: expected {unknowns} unknowns, as in {target} so far, found {found}"
    paths, had = dict(share.paths), share.paths["n_points"] > 0
    for name, value in {"status": int(Status.RAISED), "message": text(reason, TEXT), "n_points": 0}.items():
        paths[name] = np.where(had, np.array(value, paths[name].dtype), paths[name])
    return evolve(share, paths=paths, rows=slice(0, 0))


# -- other forms -----------------------------------------------------------------------------------------------


def export(file: str | PathLike[str], target: str | PathLike[str], *, compression: int = 4) -> list[File]:
    """Write an archive in another form, told by the suffix of `target`.

    ``.nc``, ``.nc4``, ``.h5``: one netCDF-4 file, with gzip and shuffle. ``.csv``, ``.csv.gz``: two tables,
    ``name.csv`` for the points and ``name.paths.csv`` for the paths, numbers in full precision.

    Parameters
    ----------
    file, target : path
    compression : int
        Level of gzip, 0 (none) to 9. CSV is compressed by its suffix alone.

    Returns
    -------
    list of pathlib.Path
        The files written.

    Raises
    ------
    ValueError
        For another suffix, or a level that gzip does not know.
    ArchiveError
        If `file` is no archive, or a target exists.
    """
    if not isinstance(compression, Integral) or not 0 <= int(compression) <= 9:
        raise ValueError(f"compression: expected a level from 0 to 9, found {compression!r}")
    name = as_file("target", target)
    with open_archive(file) as archive:
        if name.suffix in (".nc", ".nc4", ".h5"):
            check_new(name)
            what = f"exported from {archive.file.name}"
            put(name, partial(write_copy, [share_of(archive)], what=what, compression=compression))
            return [name]
        for suffix in (".csv", ".csv.gz"):
            if name.name.endswith(suffix):
                return _export_text(archive, name, name.with_name(f"{name.name.removesuffix(suffix)}.paths{suffix}"))
    raise ValueError(f"target: expected a suffix .nc, .nc4, .h5, .csv or .csv.gz, found {name.name!r}")


def _export_text(archive: Archive, points: File, paths: File) -> list[File]:
    for target in (points, paths):
        check_new(target)
    with beside(points) as first, beside(paths) as second:
        for part, table in ((first, archive.points), (second, archive.paths)):
            _write_text(part, table, points.suffix == ".gz")
        # The points last: who sees them sees both.
        publish(second, paths)
        publish(first, points)
    return [points, paths]


def _write_text(part: File, table: Table, compressed: bool) -> None:
    opened: Any = gzip.open if compressed else open
    with opened(part, "xt", encoding="utf-8", newline="") as out:
        writer = csv.writer(out)
        for start in range(0, max(table.size, 1), ROWS_AT_ONCE):
            columns = flat(table.block(slice(start, min(start + ROWS_AT_ONCE, table.size))))
            writer.writerows([[*columns]] if not start else [])
            # Python prints floats in full precision.
            writer.writerows(zip(*(values.tolist() for values in columns.values())))
    with part.open("rb") as written:
        os.fsync(written.fileno())


# -- what a kill or a damaged disk left ------------------------------------------------------------------------


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
    with ExitStack() as stack:
        contents = stack.enter_context(closing(Contents(name, salvage=True)))
        lost = {table: contents.unsound(table) for table in TABLES}
        damaged, slots = any(lost.values()) or any(contents.cut_off.values()), dict[int, bytes]()
        if damaged or contents.flaws:
            shares = _salvaged(contents, lost)
            dropped = sum(stop - start for start, stop in lost["point"]) + contents.cut_off["point"]
            flaws = "; ".join(contents.flaws) or "damaged"
            what = f"recovered: {flaws}; {dropped} points were not what was written"
        else:
            archive = stack.enter_context(open_archive(name))
            if archive.closed_by_writer and (not len(archive) or archive.paths["status"][-1] != Status.TRACING):
                return name
            shares, what = [share_of(archive)], "recovered after its writer was killed"
            open_ = shares[0].paths["status"] == int(Status.TRACING)
            _interrupted(shares[0].paths, open_, "Its writer was killed.")
            slots = slot_of(archive.checkpoint())
        real = File(os.path.realpath(name))
        stack.enter_context(closing(own(real, contents.descriptor, contents.attributes.get("process"), force=force)))
        if not len(shares[0].paths["path"]) and damaged:
            raise ArchiveError(f"{name}: is damaged, and none of its rows is sound")
        # What is dropped may be worth more to somebody else than it is to us.
        if damaged:
            _keep_aside(real)
        put(real, partial(write_copy, shares, what=what, checkpoints=slots), replace=True)
    return name


def _interrupted(paths: Mapping[str, Any], which: Any, why: str) -> None:
    paths["status"][which] = int(Status.INTERRUPTED)
    paths["message"][which] = text(f"{Status.INTERRUPTED} {why}", TEXT)


def _salvaged(contents: Contents, lost: Mapping[str, Sequence[tuple[int, int]]]) -> list[Share]:
    """The sound rows, path by path: each from its first point to the one before its first damaged block.

    `lost` has the unsound blocks of the two tables. Of a file without sound rows there is one empty share. A path whose
    own row is lost, or has lost points, was interrupted.
    """
    committed, layout = contents.committed, contents.layout
    points, paths = contents.table("point"), contents.table("path")
    sound = {"point": np.ones(committed.points, dtype=bool), "path": np.ones(committed.paths, dtype=bool)}
    for table, spans in lost.items():
        for start, stop in spans:
            sound[table][start:stop] = False
    runs, shares = dict(_runs(points, sound["point"])), []
    for number in sorted({*runs, *np.flatnonzero(sound["path"]).tolist()}):
        rows = runs.get(number, slice(0, 0))
        row = row_columns({**record_of(Path(), None, ()), "path": number, "member": number, "n_points": -1}, layout)
        if number < committed.paths and sound["path"][number]:
            row = {name: values.copy() for name, values in paths.block(slice(number, number + 1)).items()}
        if row["n_points"][0] != rows.stop - rows.start:
            row["n_points"][:] = rows.stop - rows.start
            _interrupted(row, 0, "The rest of it was damaged.")
        shares.append(Share(layout, contents.event_names, row, points, rows, number, contents))
    nothing = filled({}, layout, "path", 0)
    return shares or [Share(layout, contents.event_names, nothing, points, slice(0, 0), 0, contents)]


def _runs(points: Table, sound: Any) -> Iterator[tuple[int, slice]]:
    """For each path with a sound first point: its number, and the rows up to the first damaged block."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], sound, [False])).astype("i1"))).reshape(-1, 2)
    for start, stop in edges.tolist():
        paths, kinds = (points.some(name, slice(start, stop)) for name in ("path_index", "kind"))
        changes = np.concatenate(([0], np.flatnonzero(np.diff(paths)) + 1, [stop - start])).tolist()
        for first, last in pairwise(changes):
            # A run that begins in the middle of a path is that path's end, of no use without its beginning.
            if kinds[first] == Kind.START:
                yield int(paths[first]), slice(start + first, start + last)


def _keep_aside(file: File) -> None:
    """The damaged file under a name of its own."""
    aside = file.with_name(f"{file.name}.damaged")
    try:
        os.link(file, aside)
    except FileExistsError:
        raise ArchiveError(f"{file}: is damaged, and would be kept as {aside.name}, which exists already") from None
    except OSError as error:
        raise ArchiveError(f"{file}: is damaged, and cannot be kept as {aside.name} ({error.strerror})") from None
